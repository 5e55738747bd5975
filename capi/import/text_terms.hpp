// The terms of a .task file: observations, rewards, costs and ends as rows of Program::terms, the places and joints that they
// are about looked up in the scene.
#pragma once
#include "term_table.hpp"
#include "text_players.hpp"

namespace rdm::import {

class TermText : public PlayerText {
 public:
  using PlayerText::PlayerText;
  void read_terms();

 private:
  // places (text_places.cpp)
  Place place(const Table& t, const char* key) const;
  Place named_place(const Table& t, const toml::node& n, const char* key, const std::string& name) const;
  static void mirrored(const Part& part, const double in[3], double out[3]);
  bool place_on_hand(size_t index, const std::string& what, Place* out) const;
  int32_t first_joint(size_t index) const;
  // The turn whose y and z these are, at right angles.
  static void turn_to(const double y[3], const double z[3], double q[4]);
  // terms
  void listed_joints(const Table& t, Term* out);
  void list_joint(const Table& t, int32_t j);
  void vector(const Table& t, const char* key, double* out, bool unit) const;
  // What a term is about; the keys that say so are added to `known`.
  Term subject(const Table& t, const TermRow& row, std::vector<const char*>* known);
  void curve(const Table& t, Term* out, std::vector<const char*>* known, bool changes);
  // Without either, a cost is what is above 0; a success says which.
  void threshold(const Table& t, Term* out, std::vector<const char*>* known, bool needed);
  Term* add_term(const Table& t) { return take(t, p_.terms, &num_terms_, kMostTerms, "terms"); }

  int32_t num_terms_ = 0;
};

}  // namespace rdm::import

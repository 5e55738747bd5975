// Options as a struct: a row of a table names the member that its value goes to. So key, member, bounds and
// help are said once, and a row that does not fit its member is an error of the compiler.
//
//   struct Values {
//     double mass;
//     OptionRange friction;
//     Shape shape;
//   };
//   constexpr auto kRows = option_rows<Values>(
//       row<&Values::mass>(number_option("mass", 1, 0, 10, "kg")),
//       row<&Values::friction>(drawable(number_option("friction", 1, 0, 10, "coefficient"))),
//       row<&Values::shape, Shape::kEgg, Shape::kBox>(text_option("shape", "egg", "egg|box", "of the object")));
//
// kRows.specs is the table, kRows.read(options) a Values. A part of a list may be a list, over the struct or a
// base of it. kRows.with<&Values::mass>(2) has another default; kRows.of<&Values::mass>() is the row itself;
// kRows.without<&Values::mass, &Values::shape>() is the list without these, whose read leaves those members empty.
#pragma once
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <type_traits>

#include "base/option.hpp"

namespace rdm {

// Which rows fit a type of members, and how it is read. A text is the Options' own, and lives no longer.
template <class T>
struct OptionValue;
template <>
struct OptionValue<double> {
  static constexpr bool fits(const OptionSpec& s) { return s.kind == OptionKind::kNumber && !s.range; }
  static double read(const Options& o, const char* key) { return o.number(key); }
};
template <>
struct OptionValue<int32_t> {
  static constexpr bool fits(const OptionSpec& s) { return s.kind == OptionKind::kInteger && !s.range; }
  static int32_t read(const Options& o, const char* key) { return o.integer(key); }
};
template <>
struct OptionValue<OptionRange> {
  static constexpr bool fits(const OptionSpec& s) { return s.range; }
  static OptionRange read(const Options& o, const char* key) { return o.range(key); }
};
template <>
struct OptionValue<bool> {
  static constexpr bool fits(const OptionSpec& s) { return s.kind == OptionKind::kFlag; }
  static bool read(const Options& o, const char* key) { return o.flag(key); }
};
template <>
struct OptionValue<const char*> {
  static constexpr bool fits(const OptionSpec& s) { return s.kind == OptionKind::kText; }
  static const char* read(const Options& o, const char* key) { return o.text(key); }
};

// What the words of a text stand for, in their order.
template <class T, T... kWords>
struct OptionWords {
  static constexpr bool fits(const OptionSpec& s) {
    if (s.kind != OptionKind::kText || !s.choices) return false;
    size_t words = 1;
    for (const char* c = s.choices; *c; ++c) words += *c == '|';
    return words == sizeof...(kWords);
  }
  static T read(const Options& o, const char* key) {
    constexpr T kValues[] = {kWords...};
    return kValues[o.word(key)];
  }
};

// A row's member, and of a text the words.
template <auto kMember>
struct MemberTag {};
template <auto kMember, auto... kWords>
struct OptionMember;
template <class S, class T, T S::*kMember, auto... kWords>
struct OptionMember<kMember, kWords...> {
  using Struct = S;
  using Tag = MemberTag<kMember>;
  using Value = std::conditional_t<sizeof...(kWords) == 0, OptionValue<T>, OptionWords<T, kWords...>>;
  static void read(const Options& o, const char* key, S* out) { out->*kMember = Value::read(o, key); }
};

template <class... M>
struct MemberList {};
template <class... A, class... B>
MemberList<A..., B...> operator+(MemberList<A...>, MemberList<B...>);
template <class S, class... M>
struct OptionRows;
template <class S, class... Members>
OptionRows<S, Members...> rows_over(MemberList<Members...>);

// A table, and row by row the members of S that the values go to.
template <class S, class... M>
struct OptionRows {
  static_assert((std::is_base_of_v<typename M::Struct, S> && ...), "a row is over S or a base of it");
  using Members = MemberList<M...>;
  OptionSpec specs[sizeof...(M)];

  constexpr const OptionSpec* data() const { return specs; }
  constexpr size_t size() const { return sizeof...(M); }

  S read(const Options& options) const {
    S out{};
    const OptionSpec* at = specs;
    (M::read(options, (at++)->key, &out), ...);
    return out;
  }

  // The Options have these rows.
  bool known_to(const Options& options) const { return options.knows(specs[0].key); }

  template <auto kMember>
  constexpr const OptionSpec& of() const {
    return specs[index_of<kMember>()];
  }
  // The list with another default for a member: of a number, integer or flag, and of a text.
  template <auto kMember>
  constexpr OptionRows with(double number) const {
    OptionRows out = *this;
    out.specs[index_of<kMember>()].number = number;
    return out;
  }
  template <auto kMember>
  constexpr OptionRows with(const char* text) const {
    OptionRows out = *this;
    out.specs[index_of<kMember>()].text = text;
    return out;
  }
  // The list without the rows of these members.
  template <auto... kGone>
  constexpr auto without() const {
    using Kept =
        decltype((std::conditional_t<is_one_of<M, kGone...>(), MemberList<>, MemberList<M>>{} + ...));
    static_assert(((index_of<kGone>() < sizeof...(M)) && ...));
    decltype(rows_over<S>(Kept{})) out{};
    constexpr bool kStays[] = {!is_one_of<M, kGone...>()...};
    OptionSpec* to = out.specs;
    for (size_t i = 0; i < sizeof...(M); ++i)
      if (kStays[i]) *to++ = specs[i];
    return out;
  }

 private:
  struct Distinct : M::Tag... {};  // a member that stands twice: an error
  static_assert(sizeof(Distinct) > 0);

  template <class One, auto... kOthers>
  static consteval bool is_one_of() {
    return (std::is_same_v<typename One::Tag, MemberTag<kOthers>> || ...);
  }
  template <auto kMember>
  static consteval size_t index_of() {
    constexpr bool kIs[] = {std::is_same_v<typename M::Tag, MemberTag<kMember>>...};
    constexpr size_t kIndex = static_cast<size_t>(std::find(kIs, kIs + sizeof...(M), true) - kIs);
    static_assert(kIndex < sizeof...(M), "no row has this member");
    return kIndex;
  }
};

// Not defined. A call in a constant says that the row is of another kind than the member.
void row_does_not_fit_its_member();

// A list of one row.
template <auto kMember, auto... kWords>
consteval auto row(const OptionSpec& spec) {
  using Member = OptionMember<kMember, kWords...>;
  if (!Member::Value::fits(spec)) row_does_not_fit_its_member();
  return OptionRows<typename Member::Struct, Member>{{spec}};
}

// The lists behind each other, as one.
template <class S, class... Lists>
consteval auto option_rows(const Lists&... lists) {
  decltype(rows_over<S>((typename Lists::Members{} + ...))) all{};
  OptionSpec* at = all.specs;
  ((at = std::copy(lists.specs, lists.specs + lists.size(), at)), ...);
  return all;
}

}  // namespace rdm

#include "tasks/hand/hand_teams.hpp"

#include <cstdio>
#include <cstring>

namespace rdm {
namespace {

constexpr const char* kSides[] = {"right", "left"};

// The finger that moves with a command of the hand; null: none does, but the wrist or the arm.
const char* finger_of(const Hand& hand, int32_t command) {
  const Robot& robot = *hand.robot;
  const int32_t row = hand.joint(command);
  for (int32_t f = 0; f < robot.fingers.count; ++f)
    if (row >= robot.fingers.rows[f].first && row <= robot.tips.rows[f].link)
      return robot.fingers.rows[f].name;
  return nullptr;
}

// Appends NAME:FIELDS:FIRST-LAST to a list. An agent sees all but the fields of the other hand.
void add(const HandControl& hands, int32_t hand, const char* part, int32_t first, int32_t last,
         Vector<char>& to) {
  char text[128];
  const char* const other = hands.count() > 1 ? kSides[1 - hand] : nullptr;
  std::snprintf(text, sizeof text, "%s%s%s%s:%s%s%s:%d-%d", to.empty() ? "" : ";", kSides[hand],
                *part ? "." : "", part, other ? "!" : "*", other ? other : "", other ? ".*" : "", first,
                last);
  to.insert(to.end(), text, text + std::strlen(text));
}

// Runs of entries with one owner. An owner of two runs, of a robot whose commands are mixed, cannot be an agent: false.
bool add_fingers(const HandControl& hands, int32_t i, int32_t end, Vector<char>& to) {
  const Hand& hand = hands.hand(i);
  const int32_t first = hands.joint_entries(i), own = i == 0 ? 0 : end - hands.entries(i);
  Vector<const char*> owner(static_cast<size_t>(hands.entries(i)), hands.flying(i) ? "base" : "wrist");
  for (int32_t k = 0; k < hand.num_entries(); ++k)
    owner[static_cast<size_t>(first - own + k)] = hand.arm_actions > 0 ? "arm" : "wrist";
  for (int32_t k = 0; k < hand.num_actions; ++k)
    if (const int32_t at = hands.entry(i, k); at >= 0)
      if (const char* finger = finger_of(hand, k)) owner[static_cast<size_t>(at - own)] = finger;
  Vector<const char*> seen;
  for (size_t at = 0, stop = 0; at < owner.size(); at = stop) {
    for (stop = at + 1; stop < owner.size() && owner[stop] == owner[at];) ++stop;
    for (const char* s : seen)
      if (s == owner[at]) return false;
    seen.push_back(owner[at]);
    add(hands, i, owner[at], own + static_cast<int32_t>(at), own + static_cast<int32_t>(stop) - 1, to);
  }
  return true;
}

}  // namespace

HandTeams::HandTeams(const HandControl& hands) {
  Vector<char> each, fingers;
  bool parted = true;
  for (int32_t i = 0, end = 0; i < hands.count(); ++i) {
    const int32_t begin = end;
    end += hands.entries(i);
    add(hands, i, "", begin, end - 1, each);
    parted = parted && add_fingers(hands, i, end, fingers);
  }
  const auto keep = [&](const char* key, Vector<char>& list) {
    list.push_back('\0');
    sets_.push_back({key, std::move(list)});
  };
  if (hands.count() > 1) keep("groups.hands", each);
  if (parted) keep("groups.fingers", fingers);
}

bool HandTeams::set_at(int32_t i, const char** key, const char** list) const {
  if (i < 0 || i >= static_cast<int32_t>(sets_.size())) return false;
  *key = sets_[static_cast<size_t>(i)].key;
  *list = sets_[static_cast<size_t>(i)].list.data();
  return true;
}

}  // namespace rdm

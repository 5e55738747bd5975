#include "latin.hpp"

#include <cstdint>
#include <sstream>
#include <vector>

#include "base/format.hpp"
#include "import.hpp"

namespace rdm::import {
namespace {

// Characters from `first` on, each by a word; "_": it has none, ".": it is silent.
struct Block {
  uint32_t first;
  std::vector<std::string> words;
  Block(uint32_t begin, const char* text) : first(begin) {
    std::istringstream in(text);
    for (std::string word; in >> word;) words.push_back(word == "." ? "" : word);
  }
};

// Latin with accents; Greek; Cyrillic; hiragana, after whose pattern katakana go.
constexpr const char* kLatin =
    "A A A A A A AE C E E E E I I I I D N O O O O O _ O U U U U Y Th ss a a a a a a ae c e e e e i i i i "
    "d n o o o o o _ o u u u u y th y A a A a A a C c C c C c C c D d D d E e E e E e E e E e G g G g G "
    "g G g H h H h I i I i I i I i I i IJ ij J j K k k L l L l L l L l L l N n N n N n n N n O o O o O o "
    "OE oe R r R r R r S s S s S s S s T t T t T t U u U u U u U u U u U u W w Y y Y Z z Z z Z z s";
constexpr const char* kGreek =
    "A _ E E I _ O _ Y O i A B G D E Z E Th I K L M N X O P R _ S T Y Ph Ch Ps O I Y a e e i y a b g d e "
    "z e th i k l m n x o p r s s t y ph ch ps o i y o y o";
constexpr const char* kCyrillic =
    "E Yo Dj Gj Ye Dz I Yi J Lj Nj C Kj I U Dz A B V G D E Zh Z I J K L M N O P R S T U F Kh Ts Ch Sh "
    "Shch . Y . E Yu Ya a b v g d e zh z i j k l m n o p r s t u f kh ts ch sh shch . y . e yu ya e yo "
    "dj gj ye dz i yi j lj nj c kj i u dz";
constexpr const char* kKana =
    "a a i i u u e e o o ka ga ki gi ku gu ke ge ko go sa za shi ji su zu se ze so zo ta da chi ji tsu "
    "tsu zu te de to do na ni nu ne no ha ba pa hi bi pi fu bu pu he be pe ho bo po ma mi mu me mo ya ya "
    "yu yu yo yo ra ri ru re ro wa wa wi we wo n vu ka ke";
constexpr uint32_t kHiragana = 0x3041, kKatakana = 0x30a1;

// Hangul syllables are made of three parts, in the order of their numbers.
constexpr uint32_t kHangul = 0xac00, kHangulEnd = 0xd7a4;
constexpr const char* kInitials[] = {"g",  "kk", "n", "d",  "tt", "r", "m", "b", "pp", "s",
                                     "ss", "",   "j", "jj", "ch", "k", "t", "p", "h"};
constexpr const char* kVowels[] = {"a",  "ae", "ya", "yae", "eo", "e",  "yeo", "ye", "o",  "wa", "wae",
                                   "oe", "yo", "u",  "wo",  "we", "wi", "yu",  "eu", "ui", "i"};
constexpr const char* kFinals[] = {"",   "k",  "k",  "ks", "n",  "nj", "nh", "t", "l",  "lk",
                                   "lm", "lb", "ls", "lt", "lp", "lh", "m",  "p", "ps", "t",
                                   "t",  "ng", "t",  "t",  "k",  "t",  "p",  "t"};

std::string hangul(uint32_t c) {
  const uint32_t n = c - kHangul;
  return std::string(kInitials[n / (21 * 28)]) + kVowels[n / 28 % 21] + kFinals[n % 28];
}

std::string word_of(uint32_t c) {
  static const Block blocks[] = {
      {0xc0, kLatin}, {0x386, kGreek}, {0x400, kCyrillic}, {kHiragana, kKana}, {kKatakana, kKana}};
  if (c >= kHangul && c < kHangulEnd) return hangul(c);
  for (const Block& b : blocks)
    if (c >= b.first && c - b.first < b.words.size()) return b.words[c - b.first];
  if (c < 0xc0 || (c >= 0x2000 && c < 0x2e80) || (c >= 0x3000 && c < 0x3041)) return "_";  // signs
  if (c >= 0x300 && c < 0x370) return "";  // an accent of its own
  if (c == 0x30fc) return "";              // a long vowel
  return format("u%04x", c);
}

// The character at *at, which goes on; 0: no UTF-8.
uint32_t next_character(const std::string& text, size_t* at) {
  const auto byte = [&](size_t k) { return static_cast<unsigned char>(k < text.size() ? text[k] : 0); };
  const uint32_t lead = byte((*at)++);
  if (lead < 0x80) return lead;
  const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
  if (lead < 0xc2 || lead > 0xf4) return 0;
  uint32_t c = lead & (0x3fu >> more);
  for (int k = 0; k < more; ++k) {
    const uint32_t next = byte(*at + static_cast<size_t>(k));
    if ((next & 0xc0) != 0x80) return 0;
    c = c << 6 | (next & 0x3f);
  }
  *at += static_cast<size_t>(more);
  return c;
}

}  // namespace

std::string latin(const std::string& text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const uint32_t c = next_character(text, &at);
    if (c > 0 && c < 0x80)
      out += static_cast<char>(c);
    else
      out += c == 0 ? "_" : word_of(c);
  }
  return out;
}

}  // namespace rdm::import

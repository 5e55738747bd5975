// Texts that leave the library: one line of valid UTF-8 without control characters.
//
// Names and paths come from a host, a file or a command line and may hold anything. Who prints an error
// text to a terminal or puts it into JSON need not look at it again.
#pragma once
#include <cstddef>

namespace rdm {

// Copies `text` into `size` >= 1 bytes, terminator included: control characters (C0, DEL, C1: line ends and
// ESC among them) become spaces, bytes that are no UTF-8 are written as \xNN. Cut before the first character
// or \xNN that does not fit; false where that was so.
bool clean_text(char* out, size_t size, const char* text);

// Whether clean_text would leave the text as it is.
bool is_clean_text(const char* text);

// Copies `text`, cut before the first character that does not fit with the terminator into `size` >= 1 bytes.
void copy_text(char* out, size_t size, const char* text);

// A name for an error text, cleaned and at most 64 bytes of it: fail(code, "task %s: unknown",
// Quoted(name).text).
struct Quoted {
  explicit Quoted(const char* name);  // NULL: "NULL"
  char text[64 + 3 + 1];              // "..." where the name was cut
};

// A number for an error text or a list of options: nine digits where they are enough, else as few as read back
// exactly, so that what is outside of its bounds looks so.
struct Number {
  explicit Number(double v);
  char text[32];
};

}  // namespace rdm

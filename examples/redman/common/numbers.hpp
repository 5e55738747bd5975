// Numbers as people type them: the whole text is one decimal number, or it is none. No locale, no hexadecimal
// or octal, no blanks.
#pragma once
#include <cstdint>
#include <string>

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace tool {

bool read_whole(const std::string& text, int64_t* out);
bool read_whole(const std::string& text, uint64_t* out);
bool read_number(const std::string& text, double* out);  // finite

// Makes every flag of the command, and of its subcommands, that takes a number refuse what is none, before
// anything else looks at it: CLI11 reads -1 as the largest unsigned number, 010 as 8 and nothing as 0.
void check_numbers(CLI::App& command);

// Refuses what is below `low` or above `high`.
CLI::Validator between(double low, double high);
// Refuses what is less than `least`.
CLI::Validator at_least(double least);
// Refuses what is 0 or less.
CLI::Validator above_zero();

}  // namespace tool

// Texts that are handed out of what may be removed meanwhile.
#pragma once

namespace rdm {

// A copy that stays for the life of the process; equal texts share one. Null stays null.
const char* lasting(const char* text);

}  // namespace rdm

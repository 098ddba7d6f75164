// Script text as it comes in over a socket, and the controller's rules for its layout.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sandwright::fake {

struct ScriptFault {
  int line = 0, column = 0;  // from 1
  std::string text;
};

// What breaks the rules of an upload: `def` or `sec` in column 0, all other lines indented by at
// least a blank, the last line `end` in column 0, extended ASCII only, names of at most 31
// characters. Not `strict`: lines need not be indented.
std::optional<ScriptFault> FindLayoutFault(const std::string& text, bool strict);

// Takes whole programs out of what a client has sent so far: from `def` or `sec` to the line `end`
// in column 0. A line outside of a program is a program of its own.
std::vector<std::string> TakePrograms(std::string& received);

}  // namespace sandwright::fake

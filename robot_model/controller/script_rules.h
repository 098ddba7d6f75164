// What a controller demands of a script that is sent to it, beyond its language.
#pragma once

#include <string>
#include <vector>

namespace sandwright {

// Why the controller would drop or misread `text` as the program `name`; empty where it is in
// order: ASCII, `def name():` in column 0, every other line indented, `end` in column 0 as the last
// one, a newline behind it; the name a letter, then letters, digits or _, at most 31 characters.
std::vector<std::string> ScriptFaults(const std::string& text, const std::string& name);

}  // namespace sandwright

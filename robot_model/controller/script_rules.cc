#include "robot_model/controller/script_rules.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <sstream>

namespace sandwright {
namespace {

constexpr size_t kLongestName = 31;

bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool IsWordCharacter(char c) { return IsLetter(c) || (c >= '0' && c <= '9') || c == '_'; }
// Carriage returns are not: the parser counts them into names.
bool IsAllowed(char c) { return c == '\n' || c == '\t' || (c >= 0x20 && c <= 0x7e); }

}  // namespace

std::vector<std::string> ScriptFaults(const std::string& text, const std::string& name) {
  std::vector<std::string> faults;
  if (name.empty() || name.size() > kLongestName || !IsLetter(name.front()) ||
      !std::all_of(name.begin(), name.end(), IsWordCharacter))
    faults.push_back(fmt::format(
        "its name '{}' is not a letter with letters, digits or _ behind it, at most {} characters",
        name, kLongestName));
  if (!std::all_of(text.begin(), text.end(), IsAllowed))
    faults.push_back("a character that is not printable ASCII");
  if (!text.ends_with("\nend\n")) faults.push_back("its last line is not 'end' with a newline");

  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1 && line != "def " + name + "():")
      faults.push_back(fmt::format("line 1 is not 'def {}():'", name));
    const bool is_indented = line.starts_with(' ') || line.starts_with('\t');
    const bool is_last = lines.peek() == std::istringstream::traits_type::eof();
    if (number > 1 && !is_last && !is_indented)
      faults.push_back(fmt::format("line {} begins in column 0", number));
  }
  return faults;
}

}  // namespace sandwright

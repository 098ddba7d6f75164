#include "tests/support/controller_fake/script_text.h"

#include <regex>
#include <sstream>
#include <utility>

namespace sandwright::fake {
namespace {

bool IsEnd(const std::string& line) {
  return line.starts_with("end") && line.find_first_not_of(" \t\r", 3) == std::string::npos;
}

bool OpensProgram(const std::string& line) {
  return line.starts_with("def ") || line.starts_with("sec ");
}

// Blank, or a comment alone.
bool SaysNothing(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

}  // namespace

std::optional<ScriptFault> FindLayoutFault(const std::string& text, bool strict) {
  std::istringstream lines(text);
  std::string line;
  bool ended = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    for (size_t i = 0; i < line.size(); ++i) {
      const auto byte = static_cast<unsigned char>(line[i]);
      const auto next = i + 1 < line.size() ? static_cast<unsigned char>(line[i + 1]) : 0;
      if ((byte < 0x20 && byte != '\t' && byte != '\r') || byte == 0x7f)
        return ScriptFault{number, static_cast<int>(i) + 1, "control character"};
      // Two bytes of UTF-8 are no character of an eight-bit alphabet.
      if (byte >= 0xc2 && (next & 0xc0) == 0x80)
        return ScriptFault{number, static_cast<int>(i) + 1, "not extended ASCII"};
    }
    if (number == 1) {
      static const std::regex head(R"((def|sec) [A-Za-z_]\w{0,30}\(\):\s*)");
      if (!OpensProgram(line)) return std::nullopt;  // a single statement
      if (!std::regex_match(line, head)) return ScriptFault{1, 5, "syntax error: program name"};
    } else if (ended && !SaysNothing(line)) {
      return ScriptFault{number, 1, "syntax error: text behind the program's end"};
    } else if (IsEnd(line)) {
      ended = true;
    } else if (strict && !SaysNothing(line) && line[0] != ' ' && line[0] != '\t') {
      return ScriptFault{number, 1, "syntax error: line is not indented"};
    }
  }
  return std::nullopt;
}

std::vector<std::string> TakePrograms(std::string& received) {
  std::vector<std::string> programs;
  std::string program;
  bool inside = false;
  size_t taken = 0;
  for (size_t at = 0, end; (end = received.find('\n', at)) != std::string::npos; at = end + 1) {
    const std::string line = received.substr(at, end - at);
    if (!inside && SaysNothing(line)) {
      taken = end + 1;
      continue;
    }
    program += line + "\n";
    inside = inside || OpensProgram(line);
    if (inside && !IsEnd(line)) continue;
    programs.push_back(std::exchange(program, {}));
    inside = false;
    taken = end + 1;
  }
  received.erase(0, taken);
  return programs;
}

}  // namespace sandwright::fake

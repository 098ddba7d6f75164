// URScript text to tokens.
#pragma once

#include <string>
#include <vector>

namespace sandwright::fake {

struct Token {
  enum class Kind { kName, kInteger, kFloat, kString, kSymbol, kLineEnd, kEnd };

  Kind kind;
  std::string text;
  int line, column;  // from 1
};

// Ends with a kLineEnd and a kEnd. Throws SyntaxError for a character that begins no token.
std::vector<Token> Tokenize(const std::string& text);

}  // namespace sandwright::fake

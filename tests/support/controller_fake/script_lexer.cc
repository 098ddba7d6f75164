#include "tests/support/controller_fake/script_lexer.h"

#include <cctype>

#include "tests/support/controller_fake/script_parser.h"

namespace sandwright::fake {
namespace {

bool IsNameStart(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }

class Lexer {
 public:
  explicit Lexer(const std::string& text) : text_(text) {}

  std::vector<Token> Run() {
    while (at_ < text_.size()) Next();
    Add(Token::Kind::kLineEnd, 0);
    Add(Token::Kind::kEnd, 0);
    return std::move(tokens_);
  }

 private:
  char Peek(size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  void Add(Token::Kind kind, size_t length) {
    tokens_.push_back({kind, text_.substr(at_, length), line_, Column()});
    at_ += length;
  }

  int Column() const { return static_cast<int>(at_ - line_begin_) + 1; }

  void Next() {
    const char c = Peek();
    if (c == '\n') {
      Add(Token::Kind::kLineEnd, 1);
      ++line_;
      line_begin_ = at_;
    } else if (c == '#') {
      while (at_ < text_.size() && Peek() != '\n') ++at_;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      ++at_;
    } else if (IsNameStart(c)) {
      size_t length = 1;
      while (IsNameStart(Peek(length)) || IsDigit(Peek(length))) ++length;
      Add(Token::Kind::kName, length);
    } else if (IsDigit(c) || (c == '.' && IsDigit(Peek(1)))) {
      Number();
    } else if (c == '"') {
      const size_t close = text_.find_first_of("\"\n", at_ + 1);
      if (close == std::string::npos || text_[close] == '\n') Fail("string is not closed");
      Add(Token::Kind::kString, close - at_ + 1);
    } else {
      Symbol(c);
    }
  }

  void Number() {
    size_t length = 0;
    bool is_float = false;
    while (IsDigit(Peek(length)) || Peek(length) == '.') is_float |= Peek(length++) == '.';
    if (Peek(length) == 'e' || Peek(length) == 'E') {
      size_t digits = length + 1;
      if (Peek(digits) == '-' || Peek(digits) == '+') ++digits;
      if (!IsDigit(Peek(digits))) Fail("number");
      while (IsDigit(Peek(digits))) ++digits;
      length = digits;
      is_float = true;
    }
    Add(is_float ? Token::Kind::kFloat : Token::Kind::kInteger, length);
  }

  void Symbol(char c) {
    const bool two = Peek(1) == '=' && (c == '=' || c == '!' || c == '<' || c == '>');
    if (!two && std::string("()[],:=+-*/%<>").find(c) == std::string::npos) Fail("character");
    Add(Token::Kind::kSymbol, two ? 2 : 1);
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw SyntaxError{{line_, Column(), "syntax error: " + what}};
  }

  const std::string& text_;
  size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> Tokenize(const std::string& text) { return Lexer(text).Run(); }

}  // namespace sandwright::fake

#include "tests/support/controller_fake/script_parser.h"

#include <array>
#include <set>

#include "tests/support/controller_fake/script_lexer.h"

namespace sandwright::fake {
namespace {

using Kind = Node::Kind;

const std::set<std::string> kReserved = {
    "def",  "thread", "sec",  "end",   "if",    "elif", "else", "while",          "return",
    "halt", "break",  "pass", "local", "run",   "kill", "join", "enter_critical", "exit_critical",
    "and",  "or",     "not",  "xor",   "True",  "False", "continue", "global"};

class Parser {
 public:
  Parser(const std::string& text, bool strict) : tokens_(Tokenize(text)), strict_(strict) {
    if (!strict)
      std::erase_if(tokens_, [](const Token& t) { return t.kind == Token::Kind::kLineEnd; });
  }

  ScriptProgram Run() {
    SkipLineEnds();
    if (IsWord("def") || IsWord("sec")) {
      program_.secondary = IsWord("sec");
      program_.main = Function();
      program_.name = program_.main.name;
    } else {
      program_.main.body = New(Kind::kBlock);
      program_.main.body->children.push_back(Statement());
    }
    SkipLineEnds();
    if (Peek().kind != Token::Kind::kEnd) Fail("text behind the program's end");
    return std::move(program_);
  }

 private:
  const Token& Peek(size_t ahead = 0) const {
    return tokens_[std::min(at_ + ahead, tokens_.size() - 1)];
  }
  bool IsWord(const std::string& word) const {
    return Peek().kind == Token::Kind::kName && Peek().text == word;
  }
  bool IsSymbol(const std::string& symbol, size_t ahead = 0) const {
    return Peek(ahead).kind == Token::Kind::kSymbol && Peek(ahead).text == symbol;
  }
  bool TakeWord(const std::string& word) { return IsWord(word) && ++at_; }
  bool TakeSymbol(const std::string& symbol) { return IsSymbol(symbol) && ++at_; }
  void Expect(const std::string& symbol) {
    if (!TakeSymbol(symbol)) Fail("'" + symbol + "' is missing");
  }
  void LineEnd() {
    if (!strict_) return;
    if (Peek().kind != Token::Kind::kLineEnd) Fail("'" + Peek().text + "'");
    ++at_;
  }
  void SkipLineEnds() {
    while (Peek().kind == Token::Kind::kLineEnd) ++at_;
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw SyntaxError{{Peek().line, Peek().column, "syntax error: " + what}};
  }
  NodePtr New(Kind kind) const {
    return std::make_unique<Node>(Node{kind, Peek().line, Peek().column, "", {}, {}, {}});
  }
  std::string Name() {
    if (Peek().kind != Token::Kind::kName || kReserved.contains(Peek().text)) Fail("name");
    return tokens_[at_++].text;
  }

  // def, sec or thread, up to and with its `end`.
  ScriptFunction Function() {
    ScriptFunction function;
    function.is_thread = IsWord("thread");
    ++at_;
    function.name = Name();
    Expect("(");
    while (!IsSymbol(")")) {
      function.parameters.push_back(Name());
      if (!IsSymbol(")")) Expect(",");
    }
    Expect(")");
    function.body = BlockAfterColon();
    End();
    return function;
  }

  void End() {
    if (!TakeWord("end")) Fail("'end' is missing");
    LineEnd();
  }

  NodePtr BlockAfterColon() {
    Expect(":");
    LineEnd();
    NodePtr block = New(Kind::kBlock);
    for (SkipLineEnds(); !IsWord("end") && !IsWord("elif") && !IsWord("else"); SkipLineEnds()) {
      if (Peek().kind == Token::Kind::kEnd) Fail("'end' is missing");
      if (IsWord("def") || IsWord("thread")) {
        ScriptFunction function = Function();
        const std::string name = function.name;
        program_.functions[name] = std::move(function);
      } else {
        block->children.push_back(Statement());
      }
    }
    return block;
  }

  NodePtr Statement() {
    static const std::array<std::pair<const char*, Kind>, 7> kBare = {
        {{"break", Kind::kBreak},
         {"continue", Kind::kContinue},
         {"halt", Kind::kHalt},
         {"pass", Kind::kPass},
         {"enter_critical", Kind::kEnterCritical},
         {"exit_critical", Kind::kExitCritical},
         {"return", Kind::kReturn}}};
    if (IsWord("if")) return If();
    if (IsWord("while")) return While();
    NodePtr node;
    for (const auto& [word, kind] : kBare) {
      if (node || !IsWord(word)) continue;
      node = New(kind);
      ++at_;
      if (kind == Kind::kReturn && Peek().kind != Token::Kind::kLineEnd &&
          Peek().line == node->line)
        node->children.push_back(Expression());
    }
    if (!node && (IsWord("kill") || IsWord("join"))) {
      node = New(IsWord("kill") ? Kind::kKill : Kind::kJoin);
      ++at_;
      node->children.push_back(Expression());
    }
    if (!node) node = AssignmentOrCall();
    LineEnd();
    return node;
  }

  NodePtr If() {
    NodePtr node = New(Kind::kIf);
    do {
      ++at_;  // if, elif
      node->children.push_back(Expression());
      node->children.push_back(BlockAfterColon());
    } while (IsWord("elif"));
    if (TakeWord("else")) node->children.push_back(BlockAfterColon());
    End();
    return node;
  }

  NodePtr While() {
    NodePtr node = New(Kind::kWhile);
    ++at_;
    node->children.push_back(Expression());
    node->children.push_back(BlockAfterColon());
    End();
    return node;
  }

  NodePtr AssignmentOrCall() {
    NodePtr node = New(Kind::kAssign);
    const bool declared = IsWord("global") || IsWord("local");
    node->names = {declared ? Peek().text : ""};
    if (declared) ++at_;
    const bool plain = IsSymbol("=", 1);
    if (!declared && !plain) {
      NodePtr expression = Expression();
      if (!IsSymbol("=")) {
        node->kind = Kind::kExpression;
        node->children.push_back(std::move(expression));
        return node;
      }
      if (expression->kind != Kind::kIndex || expression->children[0]->kind != Kind::kName)
        Fail("assignment to what is no variable");
      node->text = expression->children[0]->text;
      node->children.push_back(std::move(expression->children[1]));
    } else {
      node->text = Name();
    }
    Expect("=");
    node->children.push_back(Expression());
    return node;
  }

  // Binary operations by how loosely they bind.
  NodePtr Expression(size_t level = 0) {
    static const std::array<std::set<std::string>, 5> kLevels = {
        {{"or", "xor"}, {"and"}, {"==", "!=", "<", "<=", ">", ">="}, {"+", "-"}, {"*", "/", "%"}}};
    if (level == kLevels.size()) return Unary();
    NodePtr left = Expression(level + 1);
    while (kLevels[level].contains(Peek().text) && Peek().kind != Token::Kind::kString) {
      NodePtr node = New(Kind::kBinary);
      node->text = tokens_[at_++].text;
      node->children.push_back(std::move(left));
      node->children.push_back(Expression(level + 1));
      left = std::move(node);
    }
    return left;
  }

  NodePtr Unary() {
    if (TakeSymbol("+")) return Unary();
    if (!IsSymbol("-") && !IsWord("not")) return Postfix();
    NodePtr node = New(Kind::kUnary);
    node->text = tokens_[at_++].text;
    // `not a == b` negates the comparison.
    node->children.push_back(node->text == "not" ? Expression(2) : Unary());
    return node;
  }

  NodePtr Postfix() {
    NodePtr node = Primary();
    while (IsSymbol("[")) {
      NodePtr index = New(Kind::kIndex);
      ++at_;
      index->children.push_back(std::move(node));
      index->children.push_back(Expression());
      Expect("]");
      node = std::move(index);
    }
    return node;
  }

  NodePtr Primary() {
    const Token& token = Peek();
    if (IsWord("p") && IsSymbol("[", 1)) {
      NodePtr node = New(Kind::kPose);
      at_ += 2;
      Items(*node, "]");
      if (node->children.size() == 1) return ElementOfP(std::move(node));
      if (node->children.size() != 6) Fail("a pose has six numbers");
      return node;
    }
    if (IsSymbol("[")) {
      NodePtr node = New(Kind::kList);
      ++at_;
      Items(*node, "]");
      return node;
    }
    if (TakeSymbol("(")) {
      NodePtr node = Expression();
      Expect(")");
      return node;
    }
    if (IsWord("run")) {
      NodePtr node = New(Kind::kRun);
      ++at_;
      node->text = Name();
      Expect("(");
      Expect(")");
      return node;
    }
    if (token.kind == Token::Kind::kName && !kReserved.contains(token.text)) {
      NodePtr node = New(IsSymbol("(", 1) ? Kind::kCall : Kind::kName);
      node->text = Name();
      if (node->kind == Kind::kCall) {
        ++at_;
        Items(*node, ")");
      }
      return node;
    }
    return Literal();
  }

  // With one number it is no pose, but an element of a variable that is called p.
  static NodePtr ElementOfP(NodePtr node) {
    auto name =
        std::make_unique<Node>(Node{Kind::kName, node->line, node->column, "p", {}, {}, {}});
    node->kind = Kind::kIndex;
    node->names.clear();
    node->children.insert(node->children.begin(), std::move(name));
    return node;
  }

  NodePtr Literal() {
    const Token& token = Peek();
    NodePtr node = New(Kind::kLiteral);
    switch (token.kind) {
      case Token::Kind::kInteger: node->value = Value(std::stod(token.text)).Integer(); break;
      case Token::Kind::kFloat: node->value = std::stod(token.text); break;
      case Token::Kind::kString: node->value = token.text.substr(1, token.text.size() - 2); break;
      default:
        if (!IsWord("True") && !IsWord("False")) Fail("'" + token.text + "'");
        node->value = IsWord("True");
    }
    ++at_;
    return node;
  }

  // Comma-separated up to `close`; in a call, with keywords.
  void Items(Node& node, const std::string& close) {
    while (!IsSymbol(close)) {
      const bool keyword = node.kind == Kind::kCall && IsSymbol("=", 1);
      node.names.push_back(keyword ? Name() : "");
      if (keyword) Expect("=");
      node.children.push_back(Expression());
      if (!IsSymbol(close)) Expect(",");
    }
    Expect(close);
  }

  std::vector<Token> tokens_;
  bool strict_;
  size_t at_ = 0;
  ScriptProgram program_;
};

}  // namespace

ScriptProgram ParseScript(const std::string& text, bool strict) {
  return Parser(text, strict).Run();
}

}  // namespace sandwright::fake

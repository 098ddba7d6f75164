// URScript text to a tree.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/controller_fake/script_text.h"
#include "tests/support/controller_fake/script_value.h"

namespace sandwright::fake {

struct Node;
using NodePtr = std::unique_ptr<Node>;

struct Node {
  enum class Kind {
    // Expressions.
    kLiteral,  // value
    kName,     // text
    kList,     // children
    kPose,     // six children
    kIndex,    // list, index
    kCall,     // text; children: arguments; names: keyword of each or ""
    kRun,      // text: the thread
    kUnary,    // text: - or not; one child
    kBinary,   // text: the operation; two children
    // Statements.
    kBlock,
    kExpression,  // one child
    kAssign,      // text: name; names[0]: "", "global" or "local"; children: [index,] value
    kIf,          // children: condition, block, condition, block, ..., perhaps a last block
    kWhile,       // condition, block
    kReturn,      // perhaps one child
    kBreak,
    kContinue,
    kHalt,
    kKill,  // one child
    kJoin,  // one child
    kEnterCritical,
    kExitCritical,
    kPass,
  };

  Kind kind;
  int line, column;  // from 1
  std::string text;
  Value value;
  std::vector<NodePtr> children;
  std::vector<std::string> names;
};

// A `def` or a `thread`.
struct ScriptFunction {
  std::string name;
  std::vector<std::string> parameters;
  NodePtr body;
  bool is_thread = false;
};

struct ScriptProgram {
  std::string name;
  bool secondary = false;  // `sec`: runs beside the program, without moving the arm
  ScriptFunction main;
  // Functions and threads within, wherever they stand.
  std::map<std::string, ScriptFunction> functions;
};

// Thrown by ParseScript.
struct SyntaxError {
  ScriptFault fault;
};

// A whole program, or a single statement as a program of its own. `strict`: a statement a line, as
// the manual has it; otherwise statements end where they can go on no further, as for controllers.
ScriptProgram ParseScript(const std::string& text, bool strict);

}  // namespace sandwright::fake

// Walks a program's tree in one of its threads.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/controller_fake/script_runner.h"

namespace sandwright::fake {

// A call's arguments by position or keyword.
class Arguments {
 public:
  Arguments(std::vector<Value> values, std::vector<std::string> names)
      : values_(std::move(values)), names_(std::move(names)) {}

  size_t size() const { return values_.size(); }
  // The argument at a position or of a name; null where there is none.
  const Value* Find(size_t position, const std::string& name) const;
  // Throws ScriptError where it is missing.
  const Value& At(size_t position, const std::string& name) const;
  double Number(size_t position, const std::string& name, double otherwise) const;

 private:
  std::vector<Value> values_;
  std::vector<std::string> names_;
};

class ScriptEvaluator {
 public:
  // The main thread's variables are the program's: every thread sees them.
  ScriptEvaluator(ScriptRunner& runner, ScriptThread& thread, bool is_main)
      : runner_(runner), thread_(thread), is_main_(is_main) {}

  // Throws ScriptFault for what the controller refuses, with where it was.
  void Run(const ScriptFunction& function);

  // For built-in functions.
  ScriptRunner& runner() { return runner_; }
  ScriptMachine& machine() { return runner_.machine(); }
  int thread_id() const { return thread_.id(); }
  // Until the next control period, or until a later one in which `awaited` holds.
  void Yield(std::function<bool()> awaited = {});

 private:
  enum class Flow { kOn, kBreak, kContinue, kReturn };
  using Frame = std::map<std::string, Value>;

  Flow Execute(const Node& node);
  Flow ExecuteIf(const Node& node);
  Flow ExecuteWhile(const Node& node);
  void Assign(const Node& node);
  void Join(const Node& node);
  Value Evaluate(const Node& node);
  Value Call(const Node& node);
  Value CallFunction(const ScriptFunction& function, std::vector<Value> arguments);
  Value Binary(const Node& node);
  Value* Variable(const std::string& name);

  ScriptRunner& runner_;
  ScriptThread& thread_;
  bool is_main_;
  std::vector<Frame> frames_;  // of the functions under way; the program's own frame is global
  Value returned_;
  int line_ = 0, column_ = 0;
  int64_t steps_ = 0;  // since the last yield
};

}  // namespace sandwright::fake

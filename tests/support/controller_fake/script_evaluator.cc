#include "tests/support/controller_fake/script_evaluator.h"

#include "tests/support/controller_fake/script_functions.h"

namespace sandwright::fake {
namespace {

using Kind = Node::Kind;

// Steps without a wait after which the controller says that a thread takes no time.
constexpr int64_t kMostSteps = 500'000;
constexpr size_t kDeepestCall = 100;

Value& Element(Value& list, const Value& index) {
  Value::List* items = list.As<Value::List>();
  if (!items) throw ScriptError(std::string("cannot index ") + list.TypeName());
  const int32_t i = index.Integer();
  if (i < 0 || i >= static_cast<int32_t>(items->size()))
    throw ScriptError("index " + std::to_string(i) + " is out of bounds");
  return (*items)[i];
}

int PoseIndex(const Value& index) {
  const int32_t i = index.Integer();
  if (i < 0 || i > 5) throw ScriptError("index " + std::to_string(i) + " is out of bounds");
  return i;
}

}  // namespace

const Value* Arguments::Find(size_t position, const std::string& name) const {
  for (size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] == name) return &values_[i];
  }
  return position < values_.size() && names_[position].empty() ? &values_[position] : nullptr;
}

const Value& Arguments::At(size_t position, const std::string& name) const {
  const Value* value = Find(position, name);
  if (!value) throw ScriptError("argument " + name + " is missing");
  return *value;
}

double Arguments::Number(size_t position, const std::string& name, double otherwise) const {
  const Value* value = Find(position, name);
  return value ? value->Number() : otherwise;
}

void ScriptEvaluator::Run(const ScriptFunction& function) {
  try {
    if (!is_main_) frames_.emplace_back();
    Execute(*function.body);
  } catch (const ScriptError& error) {
    throw ScriptFault{line_, column_, error.what()};
  }
}

void ScriptEvaluator::Yield(std::function<bool()> awaited) {
  steps_ = 0;
  thread_.Yield(std::move(awaited));
}

Value* ScriptEvaluator::Variable(const std::string& name) {
  if (!frames_.empty()) {
    const auto found = frames_.back().find(name);
    if (found != frames_.back().end()) return &found->second;
  }
  const auto found = runner_.globals().find(name);
  return found == runner_.globals().end() ? nullptr : &found->second;
}

ScriptEvaluator::Flow ScriptEvaluator::Execute(const Node& node) {
  if (++steps_ > kMostSteps) throw ScriptError("infinite loop: the thread takes no time");
  line_ = node.line, column_ = node.column;
  switch (node.kind) {
    case Kind::kBlock:
      for (const NodePtr& child : node.children) {
        if (const Flow flow = Execute(*child); flow != Flow::kOn) return flow;
      }
      break;
    case Kind::kExpression: Evaluate(*node.children[0]); break;
    case Kind::kAssign: Assign(node); break;
    case Kind::kIf: return ExecuteIf(node);
    case Kind::kWhile: return ExecuteWhile(node);
    case Kind::kReturn:
      returned_ = node.children.empty() ? Value() : Evaluate(*node.children[0]);
      return Flow::kReturn;
    case Kind::kBreak: return Flow::kBreak;
    case Kind::kContinue: return Flow::kContinue;
    case Kind::kHalt: throw ProgramHalted{};
    case Kind::kKill: {
      const Value thread = Evaluate(*node.children[0]);
      if (!thread.As<ThreadHandle>()) break;  // a 0 for "none"
      runner_.Kill(thread.As<ThreadHandle>()->id);
      if (thread.As<ThreadHandle>()->id == thread_.id()) throw ThreadKilled{};
      break;
    }
    case Kind::kJoin: Join(node); break;
    case Kind::kEnterCritical: runner_.EnterCritical(thread_.id()); break;
    case Kind::kExitCritical: runner_.ExitCritical(); break;
    default: break;
  }
  return Flow::kOn;
}

ScriptEvaluator::Flow ScriptEvaluator::ExecuteIf(const Node& node) {
  const auto& parts = node.children;
  size_t i = 0;
  for (; i + 1 < parts.size(); i += 2) {
    if (Evaluate(*parts[i]).Truth()) return Execute(*parts[i + 1]);
  }
  return i < parts.size() ? Execute(*parts[i]) : Flow::kOn;
}

ScriptEvaluator::Flow ScriptEvaluator::ExecuteWhile(const Node& node) {
  while (Evaluate(*node.children[0]).Truth()) {
    const Flow flow = Execute(*node.children[1]);
    if (flow == Flow::kBreak) break;
    if (flow == Flow::kReturn) return flow;
  }
  return Flow::kOn;
}

void ScriptEvaluator::Join(const Node& node) {
  const Value thread = Evaluate(*node.children[0]);
  while (thread.As<ThreadHandle>() && runner_.Alive(thread.As<ThreadHandle>()->id)) Yield();
}

void ScriptEvaluator::Assign(const Node& node) {
  const Value value = Evaluate(*node.children.back());
  line_ = node.line, column_ = node.column;
  Value* variable = Variable(node.text);
  if (node.children.size() == 2) {
    if (!variable) throw ScriptError("variable " + node.text + " is not defined");
    const Value index = Evaluate(*node.children[0]);
    if (PoseValue* pose = variable->As<PoseValue>())
      pose->numbers[PoseIndex(index)] = value.Number();
    else
      Element(*variable, index) = value;
    return;
  }
  const bool global = node.names[0] == "global" || frames_.empty();
  if (global)
    runner_.globals()[node.text] = value;
  else if (node.names[0] == "local" || !variable)
    frames_.back()[node.text] = value;
  else
    *variable = value;
}

Value ScriptEvaluator::Evaluate(const Node& node) {
  switch (node.kind) {
    case Kind::kLiteral: return node.value;
    case Kind::kName: {
      line_ = node.line, column_ = node.column;
      const Value* variable = Variable(node.text);
      if (!variable) throw ScriptError("variable " + node.text + " is not defined");
      return *variable;
    }
    case Kind::kList: {
      Value::List items;
      for (const NodePtr& child : node.children) items.push_back(Evaluate(*child));
      return items;
    }
    case Kind::kPose: {
      PoseValue pose;
      for (int i = 0; i < 6; ++i) pose.numbers[i] = Evaluate(*node.children[i]).Number();
      return pose;
    }
    case Kind::kIndex: {
      Value list = Evaluate(*node.children[0]);
      const Value index = Evaluate(*node.children[1]);
      line_ = node.line, column_ = node.column;
      if (const PoseValue* pose = list.As<PoseValue>()) return pose->numbers[PoseIndex(index)];
      return Element(list, index);
    }
    case Kind::kRun: return runner_.Run(node.text);
    case Kind::kUnary: {
      const Value value = Evaluate(*node.children[0]);
      if (node.text == "not") return !value.Truth();
      return Operate("*", value, Value(int32_t{-1}));
    }
    case Kind::kBinary: return Binary(node);
    default: return Call(node);
  }
}

Value ScriptEvaluator::Binary(const Node& node) {
  const Value left = Evaluate(*node.children[0]);
  if (node.text == "and") return left.Truth() && Evaluate(*node.children[1]).Truth();
  if (node.text == "or") return left.Truth() || Evaluate(*node.children[1]).Truth();
  const Value right = Evaluate(*node.children[1]);
  line_ = node.line, column_ = node.column;
  return Operate(node.text, left, right);
}

Value ScriptEvaluator::Call(const Node& node) {
  std::vector<Value> values;
  for (const NodePtr& child : node.children) values.push_back(Evaluate(*child));
  line_ = node.line, column_ = node.column;
  const auto& functions = runner_.program().functions;
  if (const auto own = functions.find(node.text); own != functions.end())
    return CallFunction(own->second, std::move(values));
  const BuiltIn* function = FindBuiltIn(node.text);
  if (!function) throw ScriptError("function " + node.text + " is not defined");
  return (*function)(*this, Arguments(std::move(values), node.names));
}

Value ScriptEvaluator::CallFunction(const ScriptFunction& function, std::vector<Value> arguments) {
  if (function.is_thread) throw ScriptError(function.name + " is a thread: run it");
  if (arguments.size() != function.parameters.size())
    throw ScriptError(function.name + " takes " + std::to_string(function.parameters.size()) +
                      " arguments, not " + std::to_string(arguments.size()));
  if (frames_.size() >= kDeepestCall) throw ScriptError("calls are nested too deeply");
  Frame frame;
  for (size_t i = 0; i < arguments.size(); ++i)
    frame[function.parameters[i]] = std::move(arguments[i]);
  frames_.push_back(std::move(frame));
  returned_ = Value();
  Execute(*function.body);
  frames_.pop_back();
  return std::exchange(returned_, Value());
}

}  // namespace sandwright::fake

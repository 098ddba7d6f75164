#include "tests/support/controller_fake/script_value.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <limits>

namespace sandwright::fake {
namespace {

Value FromInteger(int64_t number) {
  if (number > std::numeric_limits<int32_t>::max() || number < std::numeric_limits<int32_t>::min())
    throw ScriptError("integer overflow");
  return static_cast<int32_t>(number);
}

Value Integers(const std::string& operation, int64_t a, int64_t b) {
  if (operation == "+") return FromInteger(a + b);
  if (operation == "-") return FromInteger(a - b);
  if (operation == "*") return FromInteger(a * b);
  if (b == 0) throw ScriptError("division by zero");
  return FromInteger(a % b);
}

Value Doubles(const std::string& operation, double a, double b) {
  if (operation == "+") return a + b;
  if (operation == "-") return a - b;
  if (operation == "*") return a * b;
  if (b == 0) throw ScriptError("division by zero");
  return operation == "/" ? a / b : std::fmod(a, b);
}

bool Equal(const Value& a, const Value& b) {
  if (a.is_number() && b.is_number()) return a.Number() == b.Number();
  // A thread's handle is compared with 0 by programs that use 0 for "none".
  if (a.As<ThreadHandle>() && b.As<int32_t>()) return a.As<ThreadHandle>()->id == *b.As<int32_t>();
  if (a.As<int32_t>() && b.As<ThreadHandle>()) return Equal(b, a);
  if (std::string(a.TypeName()) != b.TypeName())
    throw ScriptError(fmt::format("cannot compare {} with {}", a.TypeName(), b.TypeName()));
  if (const bool* truth = a.As<bool>()) return *truth == b.Truth();
  if (const std::string* text = a.As<std::string>()) return *text == b.String();
  return a.ToText() == b.ToText();
}

Value Compare(const std::string& operation, double a, double b) {
  if (operation == "<") return a < b;
  if (operation == "<=") return a <= b;
  if (operation == ">") return a > b;
  return a >= b;
}

}  // namespace

Value Value::Joints(const Vector6& numbers) {
  List list;
  for (const double number : numbers) list.emplace_back(number);
  return list;
}

Value Value::Pose(const Eigen::Isometry3d& X) { return PoseValue{PoseVector(X)}; }

const char* Value::TypeName() const {
  constexpr const char* kNames[] = {"nothing", "bool", "int",  "float",
                                    "string",  "list", "pose", "thread"};
  return kNames[data_.index()];
}

double Value::Number() const {
  if (const int32_t* integer = As<int32_t>()) return *integer;
  if (const double* number = As<double>()) return *number;
  throw ScriptError(std::string("a number is needed, not ") + TypeName());
}

int32_t Value::Integer() const {
  if (const int32_t* integer = As<int32_t>()) return *integer;
  const double number = Number();
  if (number != std::floor(number)) throw ScriptError("an integer is needed, not a float");
  return *FromInteger(static_cast<int64_t>(number)).As<int32_t>();
}

bool Value::Truth() const {
  if (const bool* truth = As<bool>()) return *truth;
  throw ScriptError(std::string("a bool is needed, not ") + TypeName());
}

const std::string& Value::String() const {
  if (const std::string* text = As<std::string>()) return *text;
  throw ScriptError(std::string("a string is needed, not ") + TypeName());
}

std::vector<double> Value::Numbers() const {
  std::vector<double> numbers;
  if (const PoseValue* pose = As<PoseValue>())
    return {pose->numbers.begin(), pose->numbers.end()};
  const List* list = As<List>();
  if (!list) throw ScriptError(std::string("a list is needed, not ") + TypeName());
  for (const Value& item : *list) numbers.push_back(item.Number());
  return numbers;
}

Vector6 Value::Six() const {
  const std::vector<double> numbers = Numbers();
  if (numbers.size() != 6)
    throw ScriptError(fmt::format("6 numbers are needed, not {}", numbers.size()));
  return JointAngles::FromList(numbers).rad;
}

Eigen::Isometry3d Value::ToIsometry() const {
  if (!As<PoseValue>()) throw ScriptError(std::string("a pose is needed, not ") + TypeName());
  return PoseFromVector(Six());
}

std::string Value::ToText() const {
  if (const bool* truth = As<bool>()) return *truth ? "True" : "False";
  if (const int32_t* integer = As<int32_t>()) return std::to_string(*integer);
  if (const double* number = As<double>()) return fmt::format("{:.6g}", *number);
  if (const std::string* text = As<std::string>()) return *text;
  if (const ThreadHandle* thread = As<ThreadHandle>()) return std::to_string(thread->id);
  if (!As<List>() && !As<PoseValue>()) return "";
  std::string text;
  const auto add = [&](const std::string& item) { text += (text.empty() ? "" : ", ") + item; };
  if (const PoseValue* pose = As<PoseValue>()) {
    for (const double number : pose->numbers) add(Value(number).ToText());
    return "p[" + text + "]";
  }
  for (const Value& item : *As<List>()) add(item.ToText());
  return "[" + text + "]";
}

Value Operate(const std::string& operation, const Value& left, const Value& right) {
  if (operation == "==") return Equal(left, right);
  if (operation == "!=") return !Equal(left, right);
  if (operation == "xor") return left.Truth() != right.Truth();
  if (left.As<Value::List>() || right.As<Value::List>() || left.As<PoseValue>() ||
      right.As<PoseValue>())
    throw ScriptError(fmt::format("unsupported operand types for {}: {} and {}", operation,
                                  left.TypeName(), right.TypeName()));
  if (operation[0] == '<' || operation[0] == '>')
    return Compare(operation, left.Number(), right.Number());
  if (left.As<int32_t>() && right.As<int32_t>() && operation != "/")
    return Integers(operation, *left.As<int32_t>(), *right.As<int32_t>());
  return Doubles(operation, left.Number(), right.Number());
}

}  // namespace sandwright::fake

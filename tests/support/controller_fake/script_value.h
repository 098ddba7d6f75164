// Values of URScript. Lists and poses are values: an assignment copies them.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "tests/support/controller_fake/controller_state.h"

namespace sandwright::fake {

// A program does what the controller refuses at run time.
class ScriptError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct PoseValue {
  Vector6 numbers = Vector6::Zero();
};

struct ThreadHandle {
  int id = 0;
};

class Value {
 public:
  using List = std::vector<Value>;

  Value() = default;  // of a function without `return`
  Value(bool value) : data_(value) {}
  Value(int32_t value) : data_(value) {}
  Value(double value) : data_(value) {}
  Value(std::string value) : data_(std::move(value)) {}
  Value(List value) : data_(std::move(value)) {}
  Value(PoseValue value) : data_(value) {}
  Value(ThreadHandle value) : data_(value) {}
  // A list of six.
  static Value Joints(const Vector6& numbers);
  static Value Pose(const Eigen::Isometry3d& X);

  template <class Type>
  const Type* As() const {
    return std::get_if<Type>(&data_);
  }
  template <class Type>
  Type* As() {
    return std::get_if<Type>(&data_);
  }

  // Each throws ScriptError where the value is of another type.
  double Number() const;
  int32_t Integer() const;
  bool Truth() const;
  const std::string& String() const;
  Vector6 Six() const;  // of a list or a pose
  Eigen::Isometry3d ToIsometry() const;
  std::vector<double> Numbers() const;

  bool is_number() const { return As<int32_t>() || As<double>(); }
  std::string ToText() const;
  const char* TypeName() const;

 private:
  std::variant<std::monostate, bool, int32_t, double, std::string, List, PoseValue, ThreadHandle>
      data_;
};

// `operation`: + - * / % == != < <= > >= and or xor. Arithmetic with lists is refused, as by
// controllers before PolyScope 3.14.3, so that programs that need it are found out.
Value Operate(const std::string& operation, const Value& left, const Value& right);

}  // namespace sandwright::fake

#include <cmath>
#include <numbers>

#include "tests/support/controller_fake/script_functions.h"

namespace sandwright::fake {
namespace {

using Evaluator = ScriptEvaluator;

void AddReal(BuiltIns& functions, const std::string& name, double (*function)(double)) {
  functions[name] = [function](Evaluator&, const Arguments& a) -> Value {
    const double result = function(a.At(0, "f").Number());
    if (std::isnan(result)) throw ScriptError("argument is out of the function's domain");
    return result;
  };
}

Value Norm(Evaluator&, const Arguments& a) {
  const Value& value = a.At(0, "a");
  if (const int32_t* integer = value.As<int32_t>()) return std::abs(*integer);
  if (value.is_number()) return std::abs(value.Number());
  double square = 0;
  for (const double number : value.Numbers()) square += number * number;
  return std::sqrt(square);
}

Value Length(Evaluator&, const Arguments& a) {
  if (const std::string* text = a.At(0, "v").As<std::string>())
    return static_cast<int32_t>(text->size());
  return static_cast<int32_t>(a.At(0, "v").Numbers().size());
}

template <class Combine>
void AddPoses(BuiltIns& functions, const std::string& name, Combine combine) {
  functions[name] = [combine](Evaluator&, const Arguments& a) {
    return Value::Pose(combine(a.At(0, "p_1").ToIsometry(), a.At(1, "p_2").ToIsometry()));
  };
}

// Positions are added, orientations follow each other.
Eigen::Isometry3d Added(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = first.translation() + second.translation();
  X.linear() = first.linear() * second.linear();
  return X;
}

Eigen::Isometry3d Subtracted(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = first.translation() - second.translation();
  X.linear() = first.linear() * second.linear().transpose();
  return X;
}

}  // namespace

void AddMathFunctions(BuiltIns& functions) {
  AddReal(functions, "sqrt", std::sqrt);
  AddReal(functions, "sin", std::sin);
  AddReal(functions, "cos", std::cos);
  AddReal(functions, "tan", std::tan);
  AddReal(functions, "asin", std::asin);
  AddReal(functions, "acos", std::acos);
  AddReal(functions, "atan", std::atan);
  AddReal(functions, "d2r", [](double degrees) { return degrees * std::numbers::pi / 180; });
  AddReal(functions, "r2d", [](double radians) { return radians * 180 / std::numbers::pi; });
  for (const auto& [name, function] :
       {std::pair<const char*, double (*)(double)>{"floor", std::floor}, {"ceil", std::ceil}}) {
    functions[name] = [function = function](Evaluator&, const Arguments& a) -> Value {
      return static_cast<int32_t>(function(a.At(0, "f").Number()));
    };
  }
  functions["atan2"] = [](Evaluator&, const Arguments& a) -> Value {
    return std::atan2(a.At(0, "x").Number(), a.At(1, "y").Number());
  };
  functions["pow"] = [](Evaluator&, const Arguments& a) -> Value {
    return std::pow(a.At(0, "base").Number(), a.At(1, "exponent").Number());
  };
  functions["norm"] = Norm;
  functions["length"] = Length;
  functions["to_str"] = [](Evaluator&, const Arguments& a) -> Value {
    return a.At(0, "val").ToText();
  };
  AddPoses(functions, "pose_trans", [](const auto& a, const auto& b) { return a * b; });
  AddPoses(functions, "pose_add", Added);
  AddPoses(functions, "pose_sub", Subtracted);
  functions["pose_inv"] = [](Evaluator&, const Arguments& a) {
    return Value::Pose(a.At(0, "p_from").ToIsometry().inverse());
  };
  functions["point_dist"] = [](Evaluator&, const Arguments& a) -> Value {
    return (a.At(0, "p_from").ToIsometry().translation() -
            a.At(1, "p_to").ToIsometry().translation())
        .norm();
  };
}

const BuiltIn* FindBuiltIn(const std::string& name) {
  static const BuiltIns functions = [] {
    BuiltIns all;
    AddMathFunctions(all);
    AddMotionFunctions(all);
    AddRobotFunctions(all);
    AddSocketFunctions(all);
    return all;
  }();
  const auto found = functions.find(name);
  return found == functions.end() ? nullptr : &found->second;
}

}  // namespace sandwright::fake

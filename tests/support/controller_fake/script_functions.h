// The functions that URScript has built in, as far as the fake has them.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "tests/support/controller_fake/script_evaluator.h"

namespace sandwright::fake {

using BuiltIn = std::function<Value(ScriptEvaluator&, const Arguments&)>;
using BuiltIns = std::map<std::string, BuiltIn>;

// Null where there is none: a program that calls it fails when it does.
const BuiltIn* FindBuiltIn(const std::string& name);

// The parts of the list, one a file.
void AddMathFunctions(BuiltIns& functions);
void AddMotionFunctions(BuiltIns& functions);
void AddRobotFunctions(BuiltIns& functions);
void AddSocketFunctions(BuiltIns& functions);

}  // namespace sandwright::fake

// The RTDE variables that the fake knows: names, types, and how each is read or written.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "tests/support/controller_fake/byte_packing.h"
#include "tests/support/controller_fake/controller_state.h"

namespace sandwright::fake {

struct RtdeOutput {
  std::string type;  // "DOUBLE", "VECTOR6D", ...
  std::function<void(const ControllerState&, ByteWriter&)> write;
};

// The inputs of one package, on top of what they were.
struct RtdePackage {
  InputRegisters registers;
  uint32_t slider_mask = 0;
  double slider_fraction = 1;
};

struct RtdeInput {
  std::string type;
  std::function<void(ByteReader&, RtdePackage&)> read;
};

const std::map<std::string, RtdeOutput>& RtdeOutputs();
const std::map<std::string, RtdeInput>& RtdeInputs();

}  // namespace sandwright::fake

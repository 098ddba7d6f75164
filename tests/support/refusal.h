// What a call that throws says.
#pragma once

#include <string>

#include "data/base/error.h"

namespace sandwright {

// The message of the Error, with its kind in front where it is a refusal; "accepted" where none came.
template <class Call>
std::string RefusalOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return (error.kind() == ErrorKind::kRefused ? "refused: " : "bad input: ") +
           std::string(error.what());
  }
  return "accepted";
}

}  // namespace sandwright

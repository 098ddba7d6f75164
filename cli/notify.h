// Tells somebody else how a run ended, by a command of theirs.
#pragma once

#include <string>

#include "data/base/config.h"

namespace sandwright {

struct NotifyConfig {
  std::string command;

  void Fields(FieldList& f) {
    f.Add("command", command,
          "shell command run at the end, whatever the end is, with SANDWRIGHT_EVENT (done, stopped, "
          "failed, refused), SANDWRIGHT_TEXT and SANDWRIGHT_FOLDER; empty: none");
  }
};

// Runs the command where there is one, in the current folder, for 30 s at most. Its failure is a
// warning.
void Notify(const NotifyConfig& config, const std::string& event, const std::string& text,
            const std::string& folder);

}  // namespace sandwright

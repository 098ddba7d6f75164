#include "cli/model_replacement.h"

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/shipped.h"

namespace sandwright {

ModelReplacement::ModelReplacement(std::string candidate, const std::string& current,
                                   std::string out)
    : candidate_(std::move(candidate)), out_(std::move(out)) {
  const bool shipped = current == "default";
  current_ = shipped ? ShippedFile("models/default_surrogate.safetensors")
                     : std::filesystem::path(current);
  if (!out_.ends_with(".safetensors"))
    throw Error("--out " + out_ + ": the name of a model must end in .safetensors");
  previous_ = shipped ? current_
                      : std::filesystem::path(out_).replace_extension(".previous.safetensors");
  const std::string old_model = ReadFile(current_);
  if (std::filesystem::exists(out_) && ReadFile(out_) != old_model)
    throw Error("--out " + out_ + ": another model than --current " + current +
                " lies there: judge the candidate against that, or name another file");
  { const AtomicFile probe(out_); }  // says so before the work where it cannot be written
}

void ModelReplacement::Replace() const {
  if (previous_ != current_) WriteFileAtomically(previous_, ReadFile(current_));
  WriteFileAtomically(out_, ReadFile(candidate_));
}

}  // namespace sandwright

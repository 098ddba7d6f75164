// A model file that takes the place of another, which is kept.
#pragma once

#include <filesystem>
#include <string>

namespace sandwright {

class ModelReplacement {
 public:
  // `current`: a file, or default (the shipped surrogate). Error where a model is missing, `out` cannot be
  // written, or another model than the current one lies there.
  ModelReplacement(std::string candidate, const std::string& current, std::string out);

  const std::filesystem::path& current() const { return current_; }
  // Where the current model is afterwards: NAME.previous.safetensors beside `out`; the shipped one stays
  // where it is.
  const std::filesystem::path& previous() const { return previous_; }
  // The old one is kept before the new one is in its place.
  void Replace() const;

 private:
  std::string candidate_, out_;
  std::filesystem::path current_, previous_;
};

}  // namespace sandwright

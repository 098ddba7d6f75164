// Named float tensors with text metadata in one safetensors file (the format of
// github.com/huggingface/safetensors): how every learned model of the project is kept on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sandwright {

struct NamedTensor {
  std::vector<int64_t> shape;  // empty: a single number
  std::vector<float> values;   // row-major, product of `shape` of them
};

struct Safetensors {
  std::map<std::string, NamedTensor> tensors;
  std::map<std::string, std::string> metadata;

  // Throw Error naming `source` (the file) and the name where it is missing.
  const NamedTensor& Tensor(const std::string& name, const std::string& source) const;
  const std::string& Metadata(const std::string& key, const std::string& source) const;
};

// Throws Error naming the file: missing, truncated, not safetensors, an element type other than
// F32, or shapes and offsets that do not fit together.
Safetensors ReadSafetensors(const std::filesystem::path& file);

// Whole file, beside and renamed. The same content gives the same bytes.
void WriteSafetensors(const Safetensors& content, const std::filesystem::path& file);

}  // namespace sandwright

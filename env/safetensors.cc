#include "env/safetensors.h"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

static_assert(std::endian::native == std::endian::little, "safetensors data is little-endian");

constexpr const char* kMetadataKey = "__metadata__";
constexpr size_t kLengthBytes = sizeof(uint64_t);

[[noreturn]] void Reject(const std::filesystem::path& file, const std::string& why) {
  throw Error(fmt::format("{}: not a readable safetensors file: {}", file.string(), why));
}

// Number of elements; none where a dimension is negative or the product does not fit `limit`.
size_t ElementCount(const std::vector<int64_t>& shape, size_t limit,
                    const std::filesystem::path& file, const std::string& name) {
  size_t count = 1;
  for (int64_t size : shape) {
    if (size < 0) Reject(file, fmt::format("tensor '{}' has a negative dimension", name));
    if (size != 0 && count > limit / static_cast<size_t>(size))
      Reject(file, fmt::format("tensor '{}' is larger than the file", name));
    count *= static_cast<size_t>(size);
  }
  return count;
}

NamedTensor ReadTensor(const nlohmann::json& entry, const std::string& name, std::string_view data,
                       const std::filesystem::path& file) {
  const auto type = entry.at("dtype").get<std::string>();
  if (type != "F32")
    Reject(file, fmt::format("tensor '{}' has element type {}; allowed: F32", name, type));
  NamedTensor tensor;
  tensor.shape = entry.at("shape").get<std::vector<int64_t>>();
  const auto offsets = entry.at("data_offsets").get<std::vector<size_t>>();
  const size_t count = ElementCount(tensor.shape, data.size(), file, name);
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > data.size() ||
      offsets[1] - offsets[0] != count * sizeof(float))
    Reject(file, fmt::format("offsets of tensor '{}' do not fit its shape or the file", name));
  tensor.values.resize(count);
  if (count > 0) std::memcpy(tensor.values.data(), data.data() + offsets[0], count * sizeof(float));
  return tensor;
}

}  // namespace

const NamedTensor& Safetensors::Tensor(const std::string& name, const std::string& source) const {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw Error(fmt::format("{}: no tensor '{}'", source, name));
  return found->second;
}

const std::string& Safetensors::Metadata(const std::string& key, const std::string& source) const {
  const auto found = metadata.find(key);
  if (found == metadata.end()) throw Error(fmt::format("{}: no metadata '{}'", source, key));
  return found->second;
}

Safetensors ReadSafetensors(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file);
  uint64_t header_bytes = 0;
  if (bytes.size() < kLengthBytes) Reject(file, "it is shorter than 8 bytes");
  std::memcpy(&header_bytes, bytes.data(), kLengthBytes);
  if (header_bytes > bytes.size() - kLengthBytes)
    Reject(file, "it is truncated or of another kind");
  const std::string_view header(bytes.data() + kLengthBytes, header_bytes);
  const std::string_view data =
      std::string_view(bytes).substr(kLengthBytes + static_cast<size_t>(header_bytes));

  Safetensors content;
  try {
    const auto json = nlohmann::json::parse(header);
    for (const auto& [name, entry] : json.items()) {
      if (name == kMetadataKey) {
        content.metadata = entry.get<std::map<std::string, std::string>>();
      } else {
        content.tensors[name] = ReadTensor(entry, name, data, file);
      }
    }
  } catch (const nlohmann::json::exception& e) {
    Reject(file, std::string("its header is wrong: ") + e.what());
  }
  return content;
}

void WriteSafetensors(const Safetensors& content, const std::filesystem::path& file) {
  nlohmann::json header = nlohmann::json::object();
  if (!content.metadata.empty()) header[kMetadataKey] = content.metadata;
  std::string data;
  for (const auto& [name, tensor] : content.tensors) {
    size_t count = 1;
    for (int64_t size : tensor.shape) count *= static_cast<size_t>(size);
    SAND_CHECK(count == tensor.values.size(), name, count, tensor.values.size());
    const size_t begin = data.size();
    data.append(reinterpret_cast<const char*>(tensor.values.data()), count * sizeof(float));
    header[name] = {
        {"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {begin, data.size()}}};
  }
  std::string text = header.dump();
  text.append((kLengthBytes - text.size() % kLengthBytes) % kLengthBytes, ' ');  // aligned data
  const uint64_t length = text.size();
  std::string bytes(reinterpret_cast<const char*>(&length), kLengthBytes);
  WriteFileAtomically(file, bytes + text + data);
}

}  // namespace sandwright

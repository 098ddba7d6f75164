// The last rows of numbers of equal length: what is replayed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "data/base/random.h"
#include "env/safetensors.h"

namespace sandwright {

class RowRing {
 public:
  // `name` is that of the tensor in a checkpoint. Memory grows until `capacity` rows are there; then the oldest
  // is overwritten.
  RowRing(std::string name, int64_t row_size, int64_t capacity);

  // The row to write next: what it held before is not cleared.
  std::span<float> Next();
  int64_t size() const { return static_cast<int64_t>(values_.size()) / row_size_; }
  // One of all rows, evenly; size() > 0.
  std::span<const float> Draw(RandomStream& stream) const;

  void Save(Safetensors& content) const;
  // Throws Error naming `source` where the rows are of another size or more than the capacity.
  void Load(const Safetensors& content, const std::string& source);

 private:
  std::string name_;
  int64_t row_size_, capacity_;
  int64_t next_ = 0;
  std::vector<float> values_;  // [size, row_size]
};

}  // namespace sandwright

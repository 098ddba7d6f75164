// The few HDF5 calls that the project's files need, over the HDF5 C++ library, with errors that
// name the file and the item.
#pragma once

#include <H5Cpp.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sandwright {

// Opens a file read-only. Error: missing, truncated or not HDF5.
H5::H5File OpenHdf5(const std::filesystem::path& file);

// Writes a new file through `fill`, beside and renamed. A failure leaves an old file as it was.
void WriteHdf5(const std::filesystem::path& file, const std::function<void(H5::H5File&)>& fill);

// Throws Error naming the file where the attributes `schema` and `schema_version` are others.
void CheckSchema(const H5::H5File& file, const std::string& path, const std::string& schema,
                 int64_t version);
void WriteSchema(H5::H5File& file, const std::string& schema, int64_t version);

bool HasAttribute(const H5::H5Object& object, const std::string& name);
bool HasDataset(const H5::Group& group, const std::string& name);

// `where` (file and group) goes into messages.
double ReadNumber(const H5::H5Object& object, const std::string& name, const std::string& where);
int64_t ReadInteger(const H5::H5Object& object, const std::string& name, const std::string& where);
std::string ReadText(const H5::H5Object& object, const std::string& name, const std::string& where);
void WriteNumber(H5::H5Object& object, const std::string& name, double value);
void WriteInteger(H5::H5Object& object, const std::string& name, int64_t value);
void WriteText(H5::H5Object& object, const std::string& name, const std::string& value);

// A dataset of rank 2 as float, double or uint8_t, row-major.
template <class T>
struct Array2 {
  size_t rows = 0, columns = 0;
  std::vector<T> values;
};
template <class T>
Array2<T> ReadArray(const H5::Group& group, const std::string& name, const std::string& where);
// Compressed (shuffle + deflate) with one chunk.
template <class T>
void WriteArray(H5::Group& group, const std::string& name, const T* values, size_t rows,
                size_t columns);

// Names of the groups below `group`, in order.
std::vector<std::string> GroupNames(const H5::Group& group);

}  // namespace sandwright

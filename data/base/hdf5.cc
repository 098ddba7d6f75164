#include "data/base/hdf5.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

// The library prints its error stack on stderr unless told not to; messages are ours.
void Quiet() { H5::Exception::dontPrint(); }

template <class T>
H5::PredType NativeType();
template <>
H5::PredType NativeType<float>() {
  return H5::PredType::NATIVE_FLOAT;
}
template <>
H5::PredType NativeType<double>() {
  return H5::PredType::NATIVE_DOUBLE;
}
template <>
H5::PredType NativeType<uint8_t>() {
  return H5::PredType::NATIVE_UINT8;
}

void WriteScalar(H5::H5Object& object, const std::string& name, const H5::DataType& type,
                 const void* value) {
  object.createAttribute(name, type, H5::DataSpace(H5S_SCALAR)).write(type, value);
}

template <class T>
T ReadScalar(const H5::H5Object& object, const std::string& name, const H5::DataType& type,
             const std::string& where) {
  try {
    const H5::Attribute attribute = object.openAttribute(name);
    if (attribute.getSpace().getSimpleExtentNpoints() == 1) {
      T value = 0;
      attribute.read(type, &value);
      return value;
    }
  } catch (const H5::Exception&) {
  }
  throw Error(where + ": attribute " + name + " is missing or not one number");
}

}  // namespace

H5::H5File OpenHdf5(const std::filesystem::path& file) {
  Quiet();
  if (!std::filesystem::exists(file))
    throw Error("cannot read " + file.string() + ": no such file");
  try {
    return H5::H5File(file.string(), H5F_ACC_RDONLY);
  } catch (const H5::Exception&) {
    throw Error("cannot read " + file.string() + ": not an HDF5 file, or cut off");
  }
}

void WriteHdf5(const std::filesystem::path& file, const std::function<void(H5::H5File&)>& fill) {
  Quiet();
  AtomicFile atomic(file);
  try {
    H5::H5File h5(atomic.temporary().string(), H5F_ACC_TRUNC);
    fill(h5);
    h5.flush(H5F_SCOPE_GLOBAL);
    h5.close();
  } catch (const H5::Exception& e) {
    throw Error("cannot write " + file.string() + ": " + e.getDetailMsg());
  }
  atomic.Commit();
}

void CheckSchema(const H5::H5File& file, const std::string& path, const std::string& schema,
                 int64_t version) {
  if (!HasAttribute(file, "schema"))
    throw Error(path + ": attribute schema is missing; expected \"" + schema + "\"");
  const std::string found = ReadText(file, "schema", path);
  if (found != schema)
    throw Error(fmt::format("{}: schema is \"{}\"; expected \"{}\"", path, found, schema));
  const double found_version = ReadNumber(file, "schema_version", path);
  if (found_version != static_cast<double>(version))
    throw Error(fmt::format("{}: schema_version of {} is {}; this program reads {}", path, schema,
                            found_version, version));
}

void WriteSchema(H5::H5File& file, const std::string& schema, int64_t version) {
  WriteText(file, "schema", schema);
  WriteInteger(file, "schema_version", version);
}

bool HasAttribute(const H5::H5Object& object, const std::string& name) {
  return object.attrExists(name);
}

bool HasDataset(const H5::Group& group, const std::string& name) { return group.nameExists(name); }

double ReadNumber(const H5::H5Object& object, const std::string& name, const std::string& where) {
  return ReadScalar<double>(object, name, H5::PredType::NATIVE_DOUBLE, where);
}

int64_t ReadInteger(const H5::H5Object& object, const std::string& name, const std::string& where) {
  return ReadScalar<int64_t>(object, name, H5::PredType::NATIVE_INT64, where);
}

std::string ReadText(const H5::H5Object& object, const std::string& name,
                     const std::string& where) {
  try {
    const H5::Attribute attribute = object.openAttribute(name);
    std::string value;
    attribute.read(attribute.getDataType(), value);
    return value;
  } catch (const H5::Exception&) {
    throw Error(where + ": attribute " + name + " is missing or not a text");
  }
}

void WriteNumber(H5::H5Object& object, const std::string& name, double value) {
  WriteScalar(object, name, H5::PredType::NATIVE_DOUBLE, &value);
}

void WriteInteger(H5::H5Object& object, const std::string& name, int64_t value) {
  WriteScalar(object, name, H5::PredType::NATIVE_INT64, &value);
}

void WriteText(H5::H5Object& object, const std::string& name, const std::string& value) {
  H5::StrType type(H5::PredType::C_S1, H5T_VARIABLE);
  type.setCset(H5T_CSET_UTF8);
  const char* text = value.c_str();
  WriteScalar(object, name, type, &text);
}

template <class T>
Array2<T> ReadArray(const H5::Group& group, const std::string& name, const std::string& where) {
  try {
    const H5::DataSet dataset = group.openDataSet(name);
    const H5::DataSpace space = dataset.getSpace();
    if (space.getSimpleExtentNdims() != 2)
      throw Error(fmt::format("{}: dataset {} has rank {}; expected 2", where, name,
                              space.getSimpleExtentNdims()));
    std::array<hsize_t, 2> size;
    space.getSimpleExtentDims(size.data());
    Array2<T> array{size[0], size[1], std::vector<T>(size[0] * size[1])};
    dataset.read(array.values.data(), NativeType<T>());
    return array;
  } catch (const H5::Exception&) {
    throw Error(where + ": dataset " + name + " is missing, cut off or of another type");
  }
}

template <class T>
void WriteArray(H5::Group& group, const std::string& name, const T* values, size_t rows,
                size_t columns) {
  const std::array<hsize_t, 2> size = {rows, columns};
  H5::DSetCreatPropList properties;
  properties.setChunk(2, size.data());
  properties.setShuffle();
  properties.setDeflate(6);
  H5Pset_obj_track_times(properties.getId(), false);  // the same content gives the same bytes
  group.createDataSet(name, NativeType<T>(), H5::DataSpace(2, size.data()), properties)
      .write(values, NativeType<T>());
}

template Array2<float> ReadArray(const H5::Group&, const std::string&, const std::string&);
template Array2<double> ReadArray(const H5::Group&, const std::string&, const std::string&);
template Array2<uint8_t> ReadArray(const H5::Group&, const std::string&, const std::string&);
template void WriteArray(H5::Group&, const std::string&, const float*, size_t, size_t);
template void WriteArray(H5::Group&, const std::string&, const double*, size_t, size_t);
template void WriteArray(H5::Group&, const std::string&, const uint8_t*, size_t, size_t);

std::vector<std::string> GroupNames(const H5::Group& group) {
  std::vector<std::string> names;
  for (hsize_t i = 0; i < group.getNumObjs(); ++i) {
    if (group.getObjTypeByIdx(i) == H5G_GROUP) names.push_back(group.getObjnameByIdx(i));
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace sandwright

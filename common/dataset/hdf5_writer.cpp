#include "common/dataset/hdf5_writer.hpp"

#include <cerrno>
#include <cstring>
#include <limits>

#include "common/base/assertion.hpp"

namespace palpate::hdf5 {
namespace {

// Level 4 of gzip: nodal fields shrink by about as much as with 9, at several times its speed.
constexpr unsigned gzip_level = 4;

template <class T>
T noValue() {
  return std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN()
                                     : std::numeric_limits<T>::lowest();
}

}  // namespace

Writer::Writer(const std::filesystem::path& file)
    : name_(file.string()), disk_(file, std::ios::binary | std::ios::trunc) {
  if (!disk_) throw failure("{}: cannot be created: {}", name_, std::strerror(errno));
  silenceErrorStack();
  const Handle access(check(H5Pcreate(H5P_FILE_ACCESS), "file access properties"), H5Pclose);
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110),
        "file format version");
  check(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), "close degree");
  image_.useIn(access.get());
  const Handle creation(check(H5Pcreate(H5P_FILE_CREATE), "file creation properties"), H5Pclose);
  check(H5Pset_obj_track_times(creation.get(), false), "no time stamps");
  file_ = Handle(
      check(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), "cannot create"),
      H5Fclose);
}

void Writer::makeGroup(const std::string& path) {
  const Handle properties(check(H5Pcreate(H5P_GROUP_CREATE), path), H5Pclose);
  check(H5Pset_obj_track_times(properties.get(), false), path);
  const Handle group(
      check(H5Gcreate2(file_.get(), path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
            path),
      H5Gclose);
}

void Writer::setAttribute(hid_t object, const char* attribute, hid_t type, hid_t space,
                          const void* value) {
  Handle created(
      check(H5Acreate2(object, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT), attribute),
      H5Aclose);
  check(H5Awrite(created.get(), type, value), attribute);
  check(created.close(), attribute);
}

void Writer::setText(hid_t object, const char* attribute, std::string_view text) {
  const Handle type(check(H5Tcopy(H5T_C_S1), attribute), H5Tclose);
  const std::string value =
      text.empty() ? std::string(1, '\0') : std::string(text);  // HDF5 has no strings of size 0
  check(H5Tset_size(type.get(), value.size()), attribute);
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), attribute);
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), attribute);
  const Handle space(check(H5Screate(H5S_SCALAR), attribute), H5Sclose);
  setAttribute(object, attribute, type.get(), space.get(), value.data());
}

void Writer::setText(const std::string& object, const char* attribute, std::string_view text) {
  const Handle opened(check(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT), object), H5Oclose);
  setText(opened.get(), attribute, text);
}

void Writer::setIntegers(const std::string& object, const char* attribute,
                         std::span<const std::int32_t> values) {
  const Handle opened(check(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT), object), H5Oclose);
  const hsize_t size = values.size();
  const Handle space(check(H5Screate_simple(1, &size, nullptr), attribute), H5Sclose);
  setAttribute(opened.get(), attribute, typeOf(Element::int32).id, space.get(), values.data());
}

void Writer::setNumber(const std::string& object, const char* attribute, double value) {
  const Handle opened(check(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT), object), H5Oclose);
  const Handle space(check(H5Screate(H5S_SCALAR), attribute), H5Sclose);
  setAttribute(opened.get(), attribute, typeOf(Element::float64).id, space.get(), &value);
}

Handle Writer::create(const std::string& path, Element element, const Shape& shape,
                      hid_t properties, const char* unit) {
  check(H5Pset_obj_track_times(properties, false), path);
  const Handle space(
      check(shape.empty() ? H5Screate(H5S_SCALAR)
                          : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
            path),
      H5Sclose);
  Handle dataset(check(H5Dcreate2(file_.get(), path.c_str(), typeOf(element).id, space.get(),
                                  H5P_DEFAULT, properties, H5P_DEFAULT),
                       path),
                 H5Dclose);
  setText(dataset.get(), "unit", unit);
  return dataset;
}

void Writer::finish(hid_t dataset, ArrayInfo info) {
  setText(dataset, hash_attribute, info.hash.hex());
  arrays_.push_back(std::move(info));
}

void Writer::writeBytes(const std::string& path, Element element, const Shape& shape,
                        std::string_view bytes, const char* unit) {
  PALPATE_ASSERT(bytes.size() == countOf(shape) * typeOf(element).size,
                 "an array is written whole");
  const Handle properties(check(H5Pcreate(H5P_DATASET_CREATE), path), H5Pclose);
  Handle dataset = create(path, element, shape, properties.get(), unit);
  if (!bytes.empty())
    check(H5Dwrite(dataset.get(), typeOf(element).id, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
          path);
  finish(dataset.get(), {path, element, shape, ContentId::of(bytes)});
  check(dataset.close(), path);
}

void Writer::close() {
  const std::string_view bytes = image_.finish(file_, name_);
  disk_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  disk_.close();
  if (!disk_) throw failure("{}: cannot be written: {}", name_, std::strerror(errno));
}

template <class T>
RowWriter<T>::RowWriter(Writer& writer, std::string path, Shape shape, const char* unit)
    : writer_(writer), info_{std::move(path), elementOf<T>(), std::move(shape), {}} {
  Shape row = info_.shape;
  row[0] = 1;
  no_values_.assign(countOf(row), noValue<T>());
  const int rank = static_cast<int>(row.size());
  const Handle properties(writer_.check(H5Pcreate(H5P_DATASET_CREATE), info_.path), H5Pclose);
  writer_.check(H5Pset_chunk(properties.get(), rank, row.data()), info_.path);
  writer_.check(H5Pset_shuffle(properties.get()), info_.path);
  writer_.check(H5Pset_deflate(properties.get(), gzip_level), info_.path);
  writer_.check(H5Pset_fill_value(properties.get(), typeOf(info_.element).id, no_values_.data()),
                info_.path);
  dataset_ = writer_.create(info_.path, info_.element, info_.shape, properties.get(), unit);
  file_space_ = Handle(writer_.check(H5Dget_space(dataset_.get()), info_.path), H5Sclose);
  row_space_ =
      Handle(writer_.check(H5Screate_simple(rank, row.data(), nullptr), info_.path), H5Sclose);
}

template <class T>
void RowWriter<T>::write(std::span<const T> row) {
  PALPATE_ASSERT(row.size() == no_values_.size() && next_ < info_.shape[0],
                 "rows come in order, whole, and each once");
  Shape start(info_.shape.size(), 0);
  start[0] = next_++;
  Shape count = info_.shape;
  count[0] = 1;
  writer_.check(H5Sselect_hyperslab(file_space_.get(), H5S_SELECT_SET, start.data(), nullptr,
                                    count.data(), nullptr),
                info_.path);
  writer_.check(H5Dwrite(dataset_.get(), typeOf(info_.element).id, row_space_.get(),
                         file_space_.get(), H5P_DEFAULT, row.data()),
                info_.path);
  hasher_.add(bytesOf(row));
}

template <class T>
void RowWriter<T>::skip() {
  ++next_;
  hasher_.add(bytesOf(std::span<const T>(no_values_)));
}

template <class T>
void RowWriter<T>::finish() {
  PALPATE_ASSERT(next_ == info_.shape[0], "every row is written or skipped");
  info_.hash = hasher_.finish();
  writer_.finish(dataset_.get(), info_);
  writer_.check(dataset_.close(), info_.path);
}

template class RowWriter<float>;
template class RowWriter<std::int16_t>;

}  // namespace palpate::hdf5

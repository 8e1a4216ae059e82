#include "common/dataset/hdf5_writer.hpp"

#include <limits>

#include "common/base/assertion.hpp"

namespace palpate::hdf5 {
namespace {

// gzip level 4 compresses nodal fields about as well as level 9 and is several times faster.
constexpr unsigned gzip_level = 4;

/// Returns the bytes of `count` missing values: NaN, or the lowest int16.
std::string noValues(Element element, std::size_t count) {
  PALPATE_ASSERT(element == Element::float32 || element == Element::int16,
                 "only rows of float32 or int16 can be read");
  const std::vector<float> floats(count, std::numeric_limits<float>::quiet_NaN());
  const std::vector<std::int16_t> integers(count, std::numeric_limits<std::int16_t>::lowest());
  return std::string(element == Element::float32 ? bytesOf(std::span(floats))
                                                 : bytesOf(std::span(integers)));
}

}  // namespace

Writer::Writer(const std::filesystem::path& file) : NamedFile(file.string()) {
  const Handle access = own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access properties");
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110),
        "file format version");
  check(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), "close degree");
  // Turn off HDF5's file locks. The caller may hold a lock on the file (replaceFile), which HDF5
  // would take for a lock of another process.
  check(H5Pset_file_locking(access.get(), false, true), "file locking");
  const Handle creation = own(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file creation properties");
  check(H5Pset_obj_track_times(creation.get(), false), "time stamps");
  file_ = own(H5Fcreate(name().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose,
              "cannot be created");
}

void Writer::makeGroup(const std::string& path) {
  const Handle properties = own(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, path);
  check(H5Pset_obj_track_times(properties.get(), false), path);
  own(H5Gcreate2(file_.get(), path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose,
      path);
}

Handle Writer::open(const std::string& object) const {
  return own(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT), H5Oclose, object);
}

void Writer::setAttribute(const Handle& object, const char* attribute, hid_t type, hid_t space,
                          const void* value) {
  Handle created = own(H5Acreate2(object.get(), attribute, type, space, H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose, attribute);
  check(H5Awrite(created.get(), type, value), attribute);
  check(created.close(), attribute);
}

void Writer::setText(const Handle& object, const char* attribute, std::string_view text) {
  const Handle type = own(H5Tcopy(H5T_C_S1), H5Tclose, attribute);
  std::string value(text);
  if (value.empty()) value.push_back('\0');  // HDF5 has no strings of size 0
  check(H5Tset_size(type.get(), value.size()), attribute);
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), attribute);
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), attribute);
  const Handle space = own(H5Screate(H5S_SCALAR), H5Sclose, attribute);
  setAttribute(object, attribute, type.get(), space.get(), value.data());
}

void Writer::setText(const std::string& object, const char* attribute, std::string_view text) {
  setText(open(object), attribute, text);
}

void Writer::setIntegers(const std::string& object, const char* attribute,
                         std::span<const std::int32_t> values) {
  const hsize_t size = values.size();
  const Handle space = own(H5Screate_simple(1, &size, nullptr), H5Sclose, attribute);
  setAttribute(open(object), attribute, typeOf(Element::int32).id, space.get(), values.data());
}

void Writer::setNumber(const std::string& object, const char* attribute, double value) {
  const Handle space = own(H5Screate(H5S_SCALAR), H5Sclose, attribute);
  setAttribute(open(object), attribute, typeOf(Element::float64).id, space.get(), &value);
}

Handle Writer::create(const std::string& path, Element element, const Shape& shape,
                      hid_t properties, const char* unit) {
  PALPATE_ASSERT(path.starts_with('/'), "the path of an array must be absolute");
  check(H5Pset_obj_track_times(properties, false), path);
  const Handle space =
      own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, path);
  Handle dataset = own(H5Dcreate2(file_.get(), path.c_str(), typeOf(element).id, space.get(),
                                  H5P_DEFAULT, properties, H5P_DEFAULT),
                       H5Dclose, path);
  setText(dataset, "unit", unit);
  return dataset;
}

void Writer::finish(Handle& dataset, ArrayInfo info) {
  setText(dataset, hash_attribute, info.hash.hex());
  check(dataset.close(), info.path);
  arrays_.push_back(std::move(info));
}

void Writer::close() { check(file_.close(), "cannot be written to its end"); }

RowWriter::RowWriter(Writer& writer, std::string path, Element element, Shape shape,
                     const char* unit, RowLayout layout)
    : writer_(writer), info_{std::move(path), element, std::move(shape), {}}, layout_(layout) {
  Shape row = info_.shape;
  row.at(0) = 1;
  row_bytes_ = countOf(row) * typeOf(element).size;
  const Handle properties = writer_.own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, info_.path);
  if (layout_ == RowLayout::compressed) {
    no_values_ = noValues(element, countOf(row));
    writer_.check(H5Pset_chunk(properties.get(), static_cast<int>(row.size()), row.data()),
                  info_.path);
    writer_.check(H5Pset_shuffle(properties.get()), info_.path);
    writer_.check(H5Pset_deflate(properties.get(), gzip_level), info_.path);
    writer_.check(H5Pset_fill_value(properties.get(), typeOf(element).id, no_values_.data()),
                  info_.path);
  }
  dataset_ = writer_.create(info_.path, element, info_.shape, properties.get(), unit);
  file_space_ = writer_.own(H5Dget_space(dataset_.get()), H5Sclose, info_.path);
}

void RowWriter::addBytes(std::string_view row) {
  constexpr std::size_t at_once = std::size_t{1} << 20;
  PALPATE_ASSERT(row.size() == row_bytes_ && next_ < info_.shape[0],
                 "a row must be complete and fit into the array");
  ++next_;
  hasher_.add(row);
  pending_ += row;
  if (layout_ == RowLayout::compressed || pending_.size() >= at_once) flush();
}

void RowWriter::flush() {
  if (pending_.empty()) return;
  const hsize_t rows = pending_.size() / row_bytes_;
  const Shape counts = writer_.selectRows(file_space_, info_, next_ - rows, rows);
  const Handle in_memory =
      writer_.own(H5Screate_simple(static_cast<int>(counts.size()), counts.data(), nullptr),
                  H5Sclose, info_.path);
  writer_.check(H5Dwrite(dataset_.get(), typeOf(info_.element).id, in_memory.get(),
                         file_space_.get(), H5P_DEFAULT, pending_.data()),
                info_.path);
  pending_.clear();
}

void RowWriter::skip() {
  PALPATE_ASSERT(layout_ == RowLayout::compressed && next_ < info_.shape[0],
                 "only rows of compressed arrays can be skipped");
  ++next_;
  hasher_.add(no_values_);
}

void RowWriter::finish() {
  flush();
  PALPATE_ASSERT(next_ == info_.shape[0], "every row must be added or skipped");
  info_.hash = hasher_.finish();
  writer_.finish(dataset_, info_);
}

}  // namespace palpate::hdf5

#include "common/dataset/hdf5_reader.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include "common/base/assertion.hpp"
#include "common/base/text.hpp"

namespace palpate::hdf5 {
namespace {

// Largest length of a text attribute. A scene with a million node numbers takes 8 MB.
constexpr std::size_t max_text_bytes = std::size_t{1} << 26;
constexpr int max_rank = 3;
constexpr std::size_t verified_at_once = std::size_t{4} << 20;  // bytes
// Largest ratio of array bytes to file bytes. Deflate reaches 1032; the rest is a margin for other
// data in the file.
constexpr double max_gzip_ratio = 1040;

void refuseWhatIsNoFile(const std::filesystem::path& file, const FileKind& kind) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (status.type() == std::filesystem::file_type::not_found)
    throw badInput("{}: there is no such {}; {}", file.string(), kind.noun, kind.origin);
  if (problem) throw badInput("{}: {}", file.string(), problem.message());
  if (status.type() != std::filesystem::file_type::regular)
    throw badInput("{}: is not a file; a {} is a single .h5 file", file.string(), kind.noun);
}

bool isShape(const Shape& shape, const Shape& expected) {
  return std::ranges::equal(shape, expected, [](hsize_t is, hsize_t wanted) {
    return wanted == any_extent || is == wanted;
  });
}

/// Returns whether the array holds nodal fields, which are large and are read by rows. All other
/// arrays are read whole.
bool isReadByRows(const ArrayInfo& info) {
  return (info.element == Element::float32 || info.element == Element::int16) &&
         info.shape.size() > 1;
}

std::size_t rowBytes(const ArrayInfo& info) {
  Shape row = info.shape;
  row.at(0) = 1;
  return countOf(row) * typeOf(info.element).size;
}

double bytesReadAtOnce(const ArrayInfo& info) {
  double bytes = static_cast<double>(typeOf(info.element).size);
  for (std::size_t axis = isReadByRows(info) ? 1 : 0; axis < info.shape.size(); ++axis)
    bytes *= static_cast<double>(info.shape[axis]);
  return bytes;
}

}  // namespace

bool isOpenForWriting(const std::filesystem::path& file) {
  // Byte offsets in the superblock: of its version, and of the consistency flags, which mark a file
  // as open for write access or SWMR (HDF5 File Format Specification 3.0, II.A).
  constexpr std::size_t version = 8, flags = 11;
  std::array<char, flags + 1> head{};
  std::ifstream in(file, std::ios::binary);
  return in.read(head.data(), head.size()) && head[version] >= 3 && (head[flags] & 5) != 0;
}

Reader::Reader(const std::filesystem::path& file, const FileKind& kind)
    : NamedFile(file.string()), kind_(kind) {
  refuseWhatIsNoFile(file, kind_);
  const htri_t is_hdf5 = H5Fis_hdf5(name().c_str());
  if (is_hdf5 < 0) throw failure("{}: cannot be read: {}", name(), lastError());
  if (is_hdf5 == 0)
    throw badInput("{}: is not an HDF5 file, so not a Palpate {}", name(), kind_.noun);
  const Handle access = own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access properties");
  const auto openedWith = [&](bool locks, bool without_where_impossible) {
    check(H5Pset_file_locking(access.get(), locks, without_where_impossible), "file locking");
    return H5Fopen(name().c_str(), H5F_ACC_RDONLY, access.get());
  };
  // First open without locks: sealed files never change, and read-only network disks refuse locks.
  hid_t opened = openedWith(false, true);
  // If other code in this process already has the file open (h5py), HDF5 requires the same lock
  // settings, so try the others too.
  for (const auto& [locks, without] : {std::pair(true, true), {true, false}, {false, false}})
    if (opened < 0) opened = openedWith(locks, without);
  if (opened < 0 && isOpenForWriting(file))
    throw failure(
        "{}: is open for writing in another program (a notebook?), or was never closed: close it "
        "there; if no program has it open, run h5clear -s {} (Debian: hdf5-tools)",
        name(), shellWord(name()));
  file_ = own(opened, H5Fclose, "truncated or damaged");
  check(H5Fget_filesize(file_.get(), &file_size_), "size");
}

Error Reader::damaged(std::string_view where, std::string_view why) const {
  return failure("{}: {}: {}; {}", name(), where, why, kind_.remedy);
}

bool Reader::hasAttribute(const char* attribute) const {
  return check(H5Aexists(file_.get(), attribute), attribute) > 0;
}

/// An open attribute with its type and dataspace.
struct Reader::Attribute {
  Attribute(const Reader& in, hid_t object, const char* attribute, std::string_view where)
      : opened(in.own(H5Aopen(object, attribute, H5P_DEFAULT), H5Aclose, where)),
        type(in.own(H5Aget_type(opened.get()), H5Tclose, where)),
        space(in.own(H5Aget_space(opened.get()), H5Sclose, where)) {}

  bool isScalar() const { return H5Sget_simple_extent_type(space.get()) == H5S_SCALAR; }
  bool holds(Element element) const { return H5Tequal(type.get(), typeOf(element).id) > 0; }

  Handle opened, type, space;
};

std::string Reader::text(const char* attribute) const {
  return text(file_.get(), attribute, attribute);
}

std::string Reader::text(hid_t object, const char* attribute, std::string_view where) const {
  const Attribute read(*this, object, attribute, where);
  const hid_t type = read.type.get();
  if (H5Tget_class(type) != H5T_STRING || check(H5Tis_variable_str(type), where) > 0 ||
      !read.isScalar())
    throw damaged(where, "is not a single fixed-length string");
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > max_text_bytes) throw damaged(where, "has an invalid length");
  std::string value(size, '\0');
  check(H5Aread(read.opened.get(), type, value.data()), where);
  // Remove the zero padding.
  value.erase(value.find_last_not_of('\0') + 1);
  return value;
}

std::vector<std::int32_t> Reader::integers(const char* attribute) const {
  const Attribute read(*this, file_.get(), attribute, attribute);
  const hssize_t count = check(H5Sget_simple_extent_npoints(read.space.get()), attribute);
  if (!read.holds(Element::int32) || count > 1024)
    throw damaged(attribute, "is not a list of at most 1024 int32");
  std::vector<std::int32_t> values(static_cast<std::size_t>(count));
  check(H5Aread(read.opened.get(), read.type.get(), values.data()), attribute);
  return values;
}

double Reader::number(const char* attribute) const {
  const Attribute read(*this, file_.get(), attribute, attribute);
  if (!read.holds(Element::float64) || !read.isScalar())
    throw damaged(attribute, "is not a single float64");
  double value = 0;
  check(H5Aread(read.opened.get(), read.type.get(), &value), attribute);
  return value;
}

void Reader::findArrays() {
  const auto keep_datasets = [](hid_t, const char* path, const H5O_info_t* info,
                                void* found) -> herr_t {
    // Skip groups and named types, which contain no data.
    if (info->type == H5O_TYPE_DATASET)
      static_cast<std::vector<std::string>*>(found)->push_back("/" + std::string(path));
    return 0;
  };
  std::vector<std::string> paths;
  check(
      H5Ovisit2(file_.get(), H5_INDEX_NAME, H5_ITER_NATIVE, keep_datasets, &paths, H5O_INFO_BASIC),
      "list of arrays");
  // array() finds a path by bisection.
  std::ranges::sort(paths);
  for (const std::string& path : paths) arrays_.push_back(inspect(path));
}

Handle Reader::openArray(const std::string& path) const {
  return own(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Dclose, path);
}

ArrayInfo Reader::inspect(const std::string& path) const {
  const Handle array = openArray(path);
  const Handle type = own(H5Dget_type(array.get()), H5Tclose, path);
  const auto* const element = std::ranges::find_if(all_elements, [&](Element candidate) {
    return check(H5Tequal(type.get(), typeOf(candidate).id), path) > 0;
  });
  if (element == all_elements.end())
    throw damaged(path, "is not little-endian uint8, int16, int32, float32 or float64");

  const Handle space = own(H5Dget_space(array.get()), H5Sclose, path);
  const int rank = check(H5Sget_simple_extent_ndims(space.get()), path);
  if (rank > max_rank || H5Sget_simple_extent_type(space.get()) == H5S_NULL)
    throw damaged(path, "has an unsupported shape");
  ArrayInfo info = {path, *element, Shape(static_cast<std::size_t>(rank)), {}};
  check(H5Sget_simple_extent_dims(space.get(), info.shape.data(), nullptr), path);

  const Handle properties = own(H5Dget_create_plist(array.get()), H5Pclose, path);
  const H5D_layout_t layout = check(H5Pget_layout(properties.get()), path);
  if (layout == H5D_VIRTUAL || check(H5Pget_external_count(properties.get()), path) > 0)
    throw damaged(path, "stores its data in another file");
  // A small file must not be able to make the reader allocate huge memory.
  const double largest =
      static_cast<double>(file_size_) * (layout == H5D_CHUNKED ? max_gzip_ratio : 1);
  // An array must not have more rows than the file has bytes either, even if its rows are empty or
  // not allocated.
  const bool too_many_rows = !info.shape.empty() && info.shape[0] > file_size_;
  if (too_many_rows || bytesReadAtOnce(info) > largest)
    throw damaged(path, "has the impossible shape " + describe(info.shape));

  const auto hash =
      ContentId::fromHex(text(array.get(), hash_attribute, path + ": " + hash_attribute));
  if (!hash) throw damaged(path, "its blake2b attribute is not 64 hexadecimal digits");
  info.hash = *hash;
  info.stored = H5Dget_storage_size(array.get());
  return info;
}

const ArrayInfo& Reader::array(const std::string& path) const {
  const auto found = std::ranges::lower_bound(arrays_, path, {}, &ArrayInfo::path);
  if (found == arrays_.end() || found->path != path) throw damaged(path, "is missing");
  return *found;
}

const ArrayInfo& Reader::array(const std::string& path, Element element,
                               const Shape& expected) const {
  const ArrayInfo& info = array(path);
  if (info.element != element || !isShape(info.shape, expected))
    throw damaged(path,
                  fmt::format("is {} {} instead of {} {}", typeOf(info.element).name,
                              describe(info.shape), typeOf(element).name,
                              replacedAll(describe(expected), std::to_string(any_extent), "n")));
  return info;
}

std::size_t Reader::rowsOf(const std::string& path) const {
  const ArrayInfo& info = array(path);
  if (info.shape.empty() || isReadByRows(info)) throw damaged(path, "is not a table");
  return info.shape[0];
}

void Reader::readBytes(const ArrayInfo& info, std::span<std::byte> bytes) const {
  PALPATE_ASSERT(bytes.size() == countOf(info.shape) * typeOf(info.element).size,
                 "the buffer must fit the shape of the array");
  if (!bytes.empty())
    check(H5Dread(openArray(info.path).get(), typeOf(info.element).id, H5S_ALL, H5S_ALL,
                  H5P_DEFAULT, bytes.data()),
          info.path);
  checkHash(info, ContentId::of(bytesOf(bytes)));
}

void Reader::checkHash(const ArrayInfo& info, const ContentId& hash) const {
  if (hash != info.hash) throw damaged(info.path, "its values do not match its blake2b hash");
}

void Reader::readRowBytes(const ArrayInfo& info, std::size_t first,
                          std::span<std::byte> bytes) const {
  const std::size_t row_bytes = rowBytes(info),
                    n_rows = row_bytes > 0 ? bytes.size() / row_bytes : 0;
  if (n_rows * row_bytes != bytes.size() || first + n_rows > info.shape.at(0))
    throw damaged(info.path, "does not have the requested rows");
  if (bytes.empty()) return;
  const Handle array = openArray(info.path);
  const Handle in_file = own(H5Dget_space(array.get()), H5Sclose, info.path);
  // Give the memory dataspace the same rank as the one in the file, because HDF5 otherwise copies
  // chunks value by value.
  const Shape rows = selectRows(in_file, info, first, n_rows);
  const Handle in_memory = own(
      H5Screate_simple(static_cast<int>(rows.size()), rows.data(), nullptr), H5Sclose, info.path);
  check(H5Dread(array.get(), typeOf(info.element).id, in_memory.get(), in_file.get(), H5P_DEFAULT,
                bytes.data()),
        fmt::format("{}: rows {} to {}", info.path, first, first + n_rows - 1));
}

void Reader::verify(const ArrayInfo& info) const {
  if (info.shape.empty()) {
    std::vector<std::byte> bytes(typeOf(info.element).size);
    return readBytes(info, bytes);
  }
  ContentHasher hasher;
  const std::size_t row_bytes = rowBytes(info);
  const std::size_t at_once =
      std::max<std::size_t>(1, verified_at_once / std::max<std::size_t>(1, row_bytes));
  std::vector<std::byte> rows;
  for (std::size_t first = 0; first < info.shape[0]; first += at_once) {
    rows.resize(std::min<std::size_t>(at_once, info.shape[0] - first) * row_bytes);
    readRowBytes(info, first, rows);
    hasher.add(bytesOf(std::span(rows)));
  }
  checkHash(info, hasher.finish());
}

}  // namespace palpate::hdf5

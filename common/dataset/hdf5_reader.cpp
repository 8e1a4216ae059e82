#include "common/dataset/hdf5_reader.hpp"

#include <algorithm>

namespace palpate::hdf5 {
namespace {

// A scene with a million node numbers is 8 MB.
constexpr std::size_t max_text_bytes = std::size_t{1} << 26;
constexpr int max_rank = 3;
constexpr std::size_t verified_at_once = std::size_t{4} << 20;  // bytes
constexpr double max_gzip_ratio = 1040;  // of deflate, 1032, and a little for the rest

void refuseWhatIsNoFile(const std::filesystem::path& file, const FileKind& kind) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (status.type() == std::filesystem::file_type::not_found)
    throw badInput("{}: there is no such {}; {}", file.string(), kind.noun, kind.origin);
  if (problem) throw badInput("{}: {}", file.string(), problem.message());
  if (status.type() != std::filesystem::file_type::regular)
    throw badInput("{}: is not a file; a {} is one .h5 file", file.string(), kind.noun);
}

bool isShape(const Shape& shape, const Shape& expected) {
  return std::equal(
      shape.begin(), shape.end(), expected.begin(), expected.end(),
      [](hsize_t is, hsize_t wanted) { return wanted == any_extent || is == wanted; });
}

/// Nodal fields, which are large, are read by rows, everything else whole.
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

std::string describeExpected(const Shape& expected) {
  std::string text = describe(expected);
  const std::string any = std::to_string(any_extent);
  for (std::size_t at; (at = text.find(any)) != std::string::npos;)
    text.replace(at, any.size(), "n");
  return text;
}

}  // namespace

Reader::Reader(const std::filesystem::path& file, const FileKind& kind)
    : name_(file.string()), kind_(kind) {
  silenceErrorStack();
  refuseWhatIsNoFile(file, kind_);
  const htri_t is_hdf5 = H5Fis_hdf5(name_.c_str());
  if (is_hdf5 < 0) throw failure("{}: cannot be read: {}", name_, lastError());
  if (is_hdf5 == 0)
    throw badInput("{}: is not an HDF5 file, so not a Palpate {}", name_, kind_.noun);
  const Handle access(check(H5Pcreate(H5P_FILE_ACCESS), "file access properties"), H5Pclose);
  // A sealed file never changes, and locks fail on read-only network file systems.
  check(H5Pset_file_locking(access.get(), false, true), "file locking");
  check(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), "close degree");
  file_ =
      Handle(check(H5Fopen(name_.c_str(), H5F_ACC_RDONLY, access.get()), "truncated or damaged"),
             H5Fclose);
  check(H5Fget_filesize(file_.get(), &file_size_), "size");
}

Error Reader::damaged(std::string_view where, std::string_view why) const {
  return failure("{}: {}: {}; {}", name_, where, why, kind_.remedy);
}

bool Reader::hasAttribute(const char* attribute) const {
  return check(H5Aexists(file_.get(), attribute), attribute) > 0;
}

std::string Reader::text(const char* attribute) const {
  return text(file_.get(), attribute, attribute);
}

std::string Reader::text(hid_t object, const char* attribute, std::string_view where) const {
  const Handle opened(check(H5Aopen(object, attribute, H5P_DEFAULT), where), H5Aclose);
  const Handle type(check(H5Aget_type(opened.get()), where), H5Tclose);
  const Handle space(check(H5Aget_space(opened.get()), where), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || check(H5Tis_variable_str(type.get()), where) > 0 ||
      H5Sget_simple_extent_type(space.get()) != H5S_SCALAR)
    throw damaged(where, "is not one fixed-length string");
  const std::size_t size = H5Tget_size(type.get());
  if (size == 0 || size > max_text_bytes) throw damaged(where, "text of impossible length");
  std::string value(size, '\0');
  check(H5Aread(opened.get(), type.get(), value.data()), where);
  value.erase(value.find_last_not_of('\0') + 1);
  return value;
}

std::vector<std::int32_t> Reader::integers(const char* attribute) const {
  const Handle opened(check(H5Aopen(file_.get(), attribute, H5P_DEFAULT), attribute), H5Aclose);
  const Handle type(check(H5Aget_type(opened.get()), attribute), H5Tclose);
  const Handle space(check(H5Aget_space(opened.get()), attribute), H5Sclose);
  const hssize_t count = check(H5Sget_simple_extent_npoints(space.get()), attribute);
  if (check(H5Tequal(type.get(), typeOf(Element::int32).id), attribute) == 0 || count > 1024)
    throw damaged(attribute, "is not a short list of int32");
  std::vector<std::int32_t> values(static_cast<std::size_t>(count));
  check(H5Aread(opened.get(), type.get(), values.data()), attribute);
  return values;
}

double Reader::number(const char* attribute) const {
  const Handle opened(check(H5Aopen(file_.get(), attribute, H5P_DEFAULT), attribute), H5Aclose);
  const Handle type(check(H5Aget_type(opened.get()), attribute), H5Tclose);
  const Handle space(check(H5Aget_space(opened.get()), attribute), H5Sclose);
  if (check(H5Tequal(type.get(), typeOf(Element::float64).id), attribute) == 0 ||
      H5Sget_simple_extent_type(space.get()) != H5S_SCALAR)
    throw damaged(attribute, "is not one float64");
  double value = 0;
  check(H5Aread(opened.get(), type.get(), &value), attribute);
  return value;
}

void Reader::findArrays() {
  std::vector<std::string> paths;
  const auto keep_datasets = [](hid_t, const char* path, const H5O_info_t* info,
                                void* found) -> herr_t {
    if (info->type == H5O_TYPE_DATASET)
      static_cast<std::vector<std::string>*>(found)->push_back("/" + std::string(path));
    return 0;
  };
  check(
      H5Ovisit2(file_.get(), H5_INDEX_NAME, H5_ITER_NATIVE, keep_datasets, &paths, H5O_INFO_BASIC),
      "list of arrays");
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) arrays_.push_back(inspect(path));
}

ArrayInfo Reader::inspect(const std::string& path) const {
  ArrayInfo info;
  info.path = path;
  const Handle dataset(check(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), path), H5Dclose);

  const Handle type(check(H5Dget_type(dataset.get()), path), H5Tclose);
  bool known = false;
  for (const Element element :
       {Element::uint8, Element::int16, Element::int32, Element::float32, Element::float64})
    if (check(H5Tequal(type.get(), typeOf(element).id), path) > 0) {
      info.element = element;
      known = true;
    }
  if (!known)
    throw damaged(path, "is none of little-endian uint8, int16, int32, float32 and float64");

  const Handle space(check(H5Dget_space(dataset.get()), path), H5Sclose);
  const int rank = check(H5Sget_simple_extent_ndims(space.get()), path);
  if (rank > max_rank || H5Sget_simple_extent_type(space.get()) == H5S_NULL)
    throw damaged(path, "has no usable shape");
  info.shape.resize(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space.get(), info.shape.data(), nullptr), path);

  const Handle properties(check(H5Dget_create_plist(dataset.get()), path), H5Pclose);
  const H5D_layout_t layout = check(H5Pget_layout(properties.get()), path);
  if (layout == H5D_VIRTUAL || check(H5Pget_external_count(properties.get()), path) > 0)
    throw damaged(path, "lies in another file");
  // No small file may ask for all the memory there is.
  const double largest =
      static_cast<double>(file_size_) * (layout == H5D_CHUNKED ? max_gzip_ratio : 1);
  if (bytesReadAtOnce(info) > largest)
    throw damaged(path, "impossible shape " + describe(info.shape));

  const auto hash =
      ContentId::fromHex(text(dataset.get(), hash_attribute, path + ": " + hash_attribute));
  if (!hash) throw damaged(path, "its blake2b attribute is not 64 hexadecimal digits");
  info.hash = *hash;
  return info;
}

const ArrayInfo& Reader::array(const std::string& path) const {
  const auto found = std::lower_bound(
      arrays_.begin(), arrays_.end(), path,
      [](const ArrayInfo& info, const std::string& wanted) { return info.path < wanted; });
  if (found == arrays_.end() || found->path != path) throw damaged(path, "is missing");
  return *found;
}

const ArrayInfo& Reader::array(const std::string& path, Element element,
                               const Shape& expected) const {
  const ArrayInfo& info = array(path);
  if (info.element != element || !isShape(info.shape, expected))
    throw damaged(
        path, fmt::format("is {} {} instead of {} {}", typeOf(info.element).name,
                          describe(info.shape), typeOf(element).name, describeExpected(expected)));
  return info;
}

std::size_t Reader::rowsOf(const std::string& path) const {
  const ArrayInfo& info = array(path);
  if (info.shape.empty() || isReadByRows(info)) throw damaged(path, "is no table");
  return info.shape[0];
}

void Reader::readBytes(const ArrayInfo& info, std::span<std::byte> bytes) const {
  const Handle dataset(check(H5Dopen2(file_.get(), info.path.c_str(), H5P_DEFAULT), info.path),
                       H5Dclose);
  if (!bytes.empty())
    check(H5Dread(dataset.get(), typeOf(info.element).id, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  bytes.data()),
          info.path);
  if (ContentId::of(bytesOf(std::span<const std::byte>(bytes))) != info.hash)
    throw damaged(info.path, "its values do not match its blake2b hash");
}

void Reader::readRowBytes(const ArrayInfo& info, std::size_t first,
                          std::span<std::byte> bytes) const {
  const std::size_t row_bytes = rowBytes(info),
                    n_rows = row_bytes > 0 ? bytes.size() / row_bytes : 0;
  if (n_rows * row_bytes != bytes.size() || first + n_rows > info.shape.at(0))
    throw damaged(info.path, "has no such rows");
  if (bytes.empty()) return;
  const Handle dataset(check(H5Dopen2(file_.get(), info.path.c_str(), H5P_DEFAULT), info.path),
                       H5Dclose);
  const Handle file_space(check(H5Dget_space(dataset.get()), info.path), H5Sclose);
  Shape start(info.shape.size(), 0), count = info.shape;
  start[0] = first;
  count[0] = n_rows;
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                            nullptr),
        info.path);
  const Handle memory_space(
      check(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), info.path),
      H5Sclose);
  check(H5Dread(dataset.get(), typeOf(info.element).id, memory_space.get(), file_space.get(),
                H5P_DEFAULT, bytes.data()),
        fmt::format("{}: rows {} to {}", info.path, first, first + n_rows - 1));
}

void Reader::verify(const ArrayInfo& info) const {
  if (!isReadByRows(info)) {
    std::vector<std::byte> bytes(countOf(info.shape) * typeOf(info.element).size);
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
    hasher.add(bytesOf(std::span<const std::byte>(rows)));
  }
  if (hasher.finish() != info.hash)
    throw damaged(info.path, "its values do not match its blake2b hash");
}

}  // namespace palpate::hdf5

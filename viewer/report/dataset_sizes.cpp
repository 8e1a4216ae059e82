#include "viewer/report/dataset_sizes.hpp"

#include <algorithm>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate {
namespace {

herr_t noteSize(hid_t root, const char* name, const H5O_info_t* info, void* sizes) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const hdf5::Handle array(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
  const hdf5::Handle type(H5Dget_type(array.get()), H5Tclose);
  const hdf5::Handle space(H5Dget_space(array.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (array.get() < 0 || type.get() < 0 || count < 0) return -1;
  static_cast<std::vector<ArraySize>*>(sizes)->push_back(
      {std::string("/") + name, H5Dget_storage_size(array.get()),
       static_cast<std::uint64_t>(count) * H5Tget_size(type.get())});
  return 0;
}

}  // namespace

std::vector<ArraySize> arraySizes(const std::filesystem::path& file) {
  hdf5::silenceErrorStack();
  const std::string name = file.string();
  // As hdf5::Reader opens it: HDF5 wants the same properties from everyone who has a file open.
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  hdf5::checked(H5Pset_file_locking(access.get(), false, true), name, "file locking");
  hdf5::checked(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), name, "close degree");
  const hdf5::Handle opened(
      hdf5::checked(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), name, "cannot be opened"),
      H5Fclose);
  std::vector<ArraySize> sizes;
  hdf5::checked(
      H5Ovisit2(opened.get(), H5_INDEX_NAME, H5_ITER_INC, noteSize, &sizes, H5O_INFO_BASIC), name,
      "its arrays cannot be listed");
  std::sort(sizes.begin(), sizes.end(),
            [](const ArraySize& a, const ArraySize& b) { return a.path < b.path; });
  return sizes;
}

}  // namespace palpate

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>

#include "core/store/hdf5_file.h"

namespace mocurate::store {
namespace {

/// HDF5's side of an open file.
struct DriverFile {
  H5FD_t common;  // first: HDF5 sees this alone
  DescriptorFile* file;
  haddr_t allocated;  ///< bytes of the file that HDF5 has given out
  haddr_t end;        ///< of what was written
};

DriverFile& Own(H5FD_t* file) { return *reinterpret_cast<DriverFile*>(file); }
const DriverFile& Own(const H5FD_t* file) { return *reinterpret_cast<const DriverFile*>(file); }

H5FD_t* OpenFile(const char*, unsigned flags, hid_t access, haddr_t) {
  const auto* file = static_cast<DescriptorFile* const*>(H5Pget_driver_info(access));
  if (file == nullptr || (flags & H5F_ACC_TRUNC) == 0u) return nullptr;  // HDF5 looks first whether there is a file
  return &(new DriverFile{{}, *file, 0, 0})->common;
}

herr_t CloseFile(H5FD_t* file) {
  delete &Own(file);
  return 0;
}

herr_t QueryFeatures(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t AllocatedEnd(const H5FD_t* file, H5FD_mem_t) { return Own(file).allocated; }

herr_t SetAllocatedEnd(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  Own(file).allocated = end;
  return 0;
}

haddr_t WrittenEnd(const H5FD_t* file, H5FD_mem_t) { return Own(file).end; }

herr_t ReadBytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* buffer) {
  auto* bytes = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t count = ::pread(Own(file).file->descriptor, bytes, size, static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes += count;
    at += static_cast<haddr_t>(count);
    size -= static_cast<std::size_t>(count);
  }
  std::memset(bytes, 0, size);  // not written yet
  return 0;
}

herr_t WriteBytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, const void* buffer) {
  DriverFile& own = Own(file);
  const auto* bytes = static_cast<const char*>(buffer);
  own.end = std::max(own.end, at + size);
  while (size > 0 && own.file->error == 0 && !own.file->finished) {
    const ssize_t count = ::pwrite(own.file->descriptor, bytes, size, static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      own.file->error = count < 0 ? errno : EIO;
      break;
    }
    bytes += count;
    at += static_cast<haddr_t>(count);
    size -= static_cast<std::size_t>(count);
  }
  return 0;
}

/// Gives the file the size that HDF5 has allocated.
herr_t TruncateFile(H5FD_t* file, hid_t, hbool_t) {
  DriverFile& own = Own(file);
  own.end = own.allocated;
  if (own.file->error != 0 || own.file->finished) return 0;
  if (::ftruncate(own.file->descriptor, static_cast<off_t>(own.allocated)) != 0) own.file->error = errno;
  return 0;
}

/// No other process opens the file. HDF5 marks a file as open for writing where its driver can lock, as that in memory
/// can.
herr_t LockFile(H5FD_t*, hbool_t) { return 0; }
herr_t UnlockFile(H5FD_t*) { return 0; }

hid_t DescriptorDriver() {
  static const hid_t driver = [] {
    static H5FD_class_t driver_class = {};
    driver_class.name = "mocurate descriptor";
    driver_class.maxaddr = HADDR_MAX / 2;
    driver_class.fc_degree = H5F_CLOSE_WEAK;
    driver_class.fapl_size = sizeof(DescriptorFile*);
    driver_class.open = OpenFile;
    driver_class.close = CloseFile;
    driver_class.query = QueryFeatures;
    driver_class.get_eoa = AllocatedEnd;
    driver_class.set_eoa = SetAllocatedEnd;
    driver_class.get_eof = WrittenEnd;
    driver_class.read = ReadBytes;
    driver_class.write = WriteBytes;
    driver_class.truncate = TruncateFile;
    driver_class.lock = LockFile;
    driver_class.unlock = UnlockFile;
    const H5FD_mem_t pools[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(pools), std::end(pools), driver_class.fl_map);
    return H5FDregister(&driver_class);
  }();
  return driver;
}

}  // namespace

hid_t DescriptorAccess(DescriptorFile& file) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  DescriptorFile* pointer = &file;
  H5Pset_driver(access, DescriptorDriver(), &pointer);
  return access;
}

}  // namespace mocurate::store

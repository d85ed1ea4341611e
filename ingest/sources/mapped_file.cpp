#include "ingest/sources/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file.h"

namespace mocurate {

Expected<std::shared_ptr<const MappedFile>> MappedFile::Open(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat facts {};
  if (file < 0 || fstat(file, &facts) != 0 || facts.st_size == 0) {
    if (file >= 0) close(file);
    if (file >= 0) return EmptyFile(DisplayPath(path));
    return Fail(ErrorCode::kUnreadable, "the file cannot be opened", DisplayPath(path), "was it copied whole?");
  }
  const auto size = static_cast<std::size_t>(facts.st_size);
  void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  close(file);
  if (bytes == MAP_FAILED) {
    return Fail(ErrorCode::kUnreadable, "the file cannot be mapped", DisplayPath(path), "check the free memory");
  }
  return std::shared_ptr<const MappedFile>(new MappedFile(bytes, size));
}

MappedFile::~MappedFile() { munmap(bytes_, size_); }

}  // namespace mocurate

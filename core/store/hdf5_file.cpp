#include "core/store/hdf5_file.h"

#include <utility>

#include "core/base/file.h"

namespace mocurate::store {

Hdf5Id& Hdf5Id::operator=(Hdf5Id&& other) noexcept {
  if (this != &other) {
    Reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

void Hdf5Id::Reset() {
  if (id_ >= 0 && close_ != nullptr) close_(id_);
  id_ = -1;
}

void SilenceHdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::string Where(const std::filesystem::path& file, const std::string& field) {
  return DisplayPath(file) + ":" + field;
}

}  // namespace mocurate::store

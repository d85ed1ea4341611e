#include <cstddef>
#include <cstdint>

#include "core/formats/amc.h"
#include "tests/support/acclaim_writers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  static const Asf arm = ParseAsf(
                             ":root\norder TX TY TZ RX RY RZ\n:bonedata\nbegin\nid 1\nname a\ndirection 1 0 0\nlength "
                             "2\naxis 0 0 90 XYZ\ndof "
                             "rx rz\nend\nbegin\nid 2\nname b\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\ndof "
                             "ry\nend\n:hierarchy\nroot a\na "
                             "b\n",
                             "arm")
                             .value();
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const Asf* skeleton : {static_cast<const Asf*>(nullptr), &arm}) {
    (void)ParseAmc(bytes, {skeleton, DamagedRows::kReport}, "fuzz");
    const auto amc = ParseAmc(bytes, {skeleton, DamagedRows::kRefuse}, "fuzz");
    if (!amc) continue;
    const auto again = ParseAmc(WriteAmc(*amc), {skeleton, DamagedRows::kRefuse}, "again");
    if (!again || again->values != amc->values || again->present != amc->present) __builtin_trap();
    std::vector<Vector3d> ends;
    AcclaimForward(arm, *amc, amc->frames - 1, ends);
  }
  return 0;
}

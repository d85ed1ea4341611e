#include <nlohmann/json.hpp>

#include "canon/card/dataset_card.h"
#include "core/base/file.h"
#include "core/base/terminal.h"
#include "job/verbs/output_checks.h"
#include "job/verbs/verbs.h"

namespace mocurate {

Status DatasetCardVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto card = DescribeDataset(arguments.path);
  if (!card) return Forward(card);
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  const std::string text =
      arguments.croissant ? CardCroissant(*card).dump(1, ' ', true, kReplace) + "\n" : CardMarkdown(*card);
  if (!arguments.output.empty()) {
    if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
    if (Status written = WriteFile(arguments.output, text); !written) return written;
  }
  if (common.json) {
    common.answered = true;
    PrintJson(*card);
  } else if (arguments.output.empty()) {
    Print("%s", text.c_str());
  }
  return {};
}

}  // namespace mocurate

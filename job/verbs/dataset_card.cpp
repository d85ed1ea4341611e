#include <cstdio>
#include <nlohmann/json.hpp>

#include "canon/card/dataset_card.h"
#include "core/base/file.h"
#include "job/verbs/dataset_answers.h"
#include "job/verbs/output_checks.h"

namespace mocurate {

Status DatasetCardVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto card = DescribeDataset(arguments.path);
  if (!card) return Forward(card);
  const std::string text = arguments.croissant ? JsonText(CardCroissant(*card)) : CardMarkdown(*card);
  if (!arguments.output.empty()) {
    if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
    if (Status written = WriteFile(arguments.output, text); !written) return written;
  }
  if (common.json) {
    common.answered = true;
    std::printf("%s", JsonText(*card).c_str());
  } else if (arguments.output.empty()) {
    std::printf("%s", text.c_str());
  }
  return {};
}

}  // namespace mocurate

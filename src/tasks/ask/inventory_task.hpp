// SPDX-License-Identifier: Apache-2.0
// The inventory as an answer, alone or compared with a register.
#pragma once

#include "tasks/ask/task_answer.hpp"
#include "tasks/inventory/register.hpp"

namespace cluxel::tasks {

/// What a person should know of an inventory beside its items: what is left out and why, and streets that are all far.
std::vector<std::string> notesOf(const mapping::MapReader& map, const InventoryParams& params,
                                 const Inventory& inventory);
/// With the columns of the task `inventory` and, where there are streets, the name of the nearest one as the third.
TaskAnswer inventoryAnswer(const mapping::MapReader& map, const InventoryParams& params,
                           const std::vector<Street>& streets = {});
/// A row for each entry of the register and for each thing that is not in it.
TaskAnswer registerAnswer(const mapping::MapReader& map, const InventoryParams& params,
                          const std::vector<RegisterEntry>& entries, const RegisterParams& comparison);

}  // namespace cluxel::tasks

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/served_dataset.h"

namespace terray::server {

/// A dataset to be served, as the user named it.
struct DatasetSpec {
    std::string name;
    std::filesystem::path directory;
    bool operator==(const DatasetSpec&) const = default;
};

/// Reads "NAME=DIR" words; "@FILE" stands for those in a file, one a line, empty lines and lines of # aside. A name has
/// letters, digits, '.', '_', '-', begins with a letter or digit, and is neither "health" nor "metrics".
/// Throws Error(usage) for a word that is none or a name given twice, Error(input) for a list that cannot be read.
[[nodiscard]] std::vector<DatasetSpec> parseSpecs(const std::vector<std::string>& words);

/// The datasets that are served, by name. Never changes: a reload makes another.
class Catalogue {
  public:
    using Datasets = std::vector<std::shared_ptr<const ServedDataset>>;

    explicit Catalogue(Datasets datasets);

    [[nodiscard]] const Datasets& datasets() const { return datasets_; }
    /// Null when there is none of that name.
    [[nodiscard]] const ServedDataset* find(std::string_view name) const;
    /// Body of "/": each dataset's name, version, bounds, levels, and links relative to "/".
    [[nodiscard]] const std::string& json() const { return json_; }

  private:
    Datasets datasets_;  ///< ordered by name
    std::string json_;
};

/// Opens every dataset. Throws Error(dataset) at the first that cannot be.
[[nodiscard]] std::shared_ptr<const Catalogue> openCatalogue(const std::vector<DatasetSpec>& specs);

/// Opens every dataset anew for a server that runs. One that cannot be opened stays as it was in `previous`, or is left
/// out; one that is unchanged stays the same object.
/// @param complain  called with a sentence for each that cannot be opened
[[nodiscard]] std::shared_ptr<const Catalogue> reloadCatalogue(const std::vector<DatasetSpec>& specs,
                                                               const Catalogue& previous,
                                                               const std::function<void(const std::string&)>& complain);

}  // namespace terray::server

#include "client/stream/job_reader.h"

#include <utility>

#include "common/check.h"

namespace terray {

void JobReader::begin(JobPtr job) {
    const TileKey key = job->key;
    const auto [place, isNew] = jobs_.try_emplace(key);
    TERRAY_CHECK(isNew);
    Reading& reading = place->second;
    reading.job = std::move(job);
    for (size_t part = 0; part < reading.job->parts.size(); ++part)
        if (reading.job->parts[part].toBeRead()) beginPart(reading, part);
}

void JobReader::beginPart(Reading& reading, size_t part) {
    const TilePart& wanted = reading.job->parts[part];
    const uint64_t ticket = ++lastTicket_;
    tickets_.emplace(ticket, reading.job->key);
    reading.parts.emplace(ticket, part);
    reads_->begin(ticket, wanted.key.layer, wanted.key.id, wanted.reads > 0);
}

void JobReader::cancelParts(Reading& reading) {
    std::erase_if(reading.parts,
                  [this](const auto& entry) { return reads_->cancel(entry.first) && tickets_.erase(entry.first) > 0; });
}

std::vector<JobReader::JobPtr> JobReader::cancelUnless(const TileKeySet& wanted) {
    for (auto& [key, reading] : jobs_)
        if (!wanted.contains(key)) cancelParts(reading);
    return takeEnded();
}

std::vector<JobReader::JobPtr> JobReader::wait(bool block) {
    for (TileRead& read : reads_->wait(block)) take(std::move(read));
    return takeEnded();
}

void JobReader::take(TileRead read) {
    const auto ticket = tickets_.find(read.ticket);
    TERRAY_CHECK(ticket != tickets_.end());
    Reading& reading = jobs_.at(ticket->second);
    tickets_.erase(ticket);
    const auto entry = reading.parts.find(read.ticket);
    const size_t index = entry->second;
    reading.parts.erase(entry);

    TilePart& part = reading.job->parts[index];
    if (!read.reachable) {
        reading.job->unreachable = read.payload.failure().message;
    } else if (++part.reads; read.payload) {
        payloadBytes_ += read.payload->size();
        part.storedBytes = read.payload->size();
        part.payload = *std::move(read.payload);
    } else {
        part.trouble = read.payload.failure().message;
    }
    if (part.toBeRead() && read.reachable && !reading.hopeless) {
        beginPart(reading, index);
        return;
    }
    if (read.reachable && !part.lost()) return;
    reading.hopeless = true;
    cancelParts(reading);
}

std::vector<JobReader::JobPtr> JobReader::takeEnded() {
    std::vector<JobPtr> ended;
    for (auto place = jobs_.begin(); place != jobs_.end();) {
        if (!place->second.parts.empty()) {
            ++place;
            continue;
        }
        ended.push_back(std::move(place->second.job));
        place = jobs_.erase(place);
    }
    return ended;
}

}  // namespace terray

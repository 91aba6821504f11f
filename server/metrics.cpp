#include "server/metrics.h"

#include "common/json.h"
#include "common/version.h"

namespace terray::server {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;  // each counter stands for itself

/// Writes metrics one after the other.
class Text {
  public:
    /// Begins a metric: its explanation and its kind, "counter", "gauge" or "histogram".
    void begin(const std::string& name, const std::string& kind, const std::string& help) {
        name_ = "terray_server_" + name;
        text_ += "# HELP " + name_ + " " + help + "\n# TYPE " + name_ + " " + kind + "\n";
    }
    /// One sample; `rest` is a suffix of the name and labels.
    void sample(const std::string& rest, double value) { text_ += name_ + rest + " " + Json(value).dump() + "\n"; }
    void single(const std::string& name, const std::string& kind, const std::string& help, double value) {
        begin(name, kind, help);
        sample("", value);
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

  private:
    std::string name_;
    std::string text_;
};

double number(const std::atomic<uint64_t>& counter) {
    return static_cast<double>(counter.load(kRelaxed));
}

void writeSeconds(Text& out, const Metrics& metrics) {
    out.begin("answer_seconds", "histogram", "Time from the end of a request to the last byte of its answer.");
    double total = 0;
    for (size_t i = 0; i < metrics.seconds.size(); ++i) {
        total += number(metrics.seconds[i]);
        const bool isLast = i == Metrics::kSecondBounds.size();
        const std::string bound = isLast ? "+Inf" : Json(Metrics::kSecondBounds[i]).dump();
        out.sample("_bucket{le=\"" + bound + "\"}", total);
    }
    out.sample("_sum", number(metrics.microseconds) * 1e-6);
    out.sample("_count", total);
}

void writeTiles(Text& out, const Metrics& metrics) {
    out.single("tile_hits_total", "counter", "Tiles asked for that were kept.", number(metrics.tileHits));
    out.single("tile_reads_total", "counter", "Tiles read because a client asked.", number(metrics.tileReads));
    out.single("tile_joins_total", "counter", "Requests that joined a read under way.", number(metrics.tileJoins));
    out.single("tile_evictions_total", "counter", "Tiles dropped to stay within --cache.",
               number(metrics.tileEvictions));
    out.single("ahead_reads_total", "counter", "Tiles read before anyone asked.", number(metrics.aheadReads));
    out.single("ahead_used_total", "counter", "Of them, those asked for while kept.", number(metrics.aheadUsed));
    out.single("cache_bytes", "gauge", "Bytes of tiles kept.", number(metrics.cacheBytes));
}

}  // namespace

void Metrics::count(int status, uint64_t bytes, std::chrono::microseconds time, bool whole) {
    answers[static_cast<size_t>(status / 100) % answers.size()].fetch_add(1, kRelaxed);
    bytesSent.fetch_add(bytes, kRelaxed);
    if (!whole) cutShort.fetch_add(1, kRelaxed);
    size_t bucket = 0;
    const double taken = std::chrono::duration<double>(time).count();
    while (bucket < kSecondBounds.size() && taken > kSecondBounds[bucket]) ++bucket;
    seconds[bucket].fetch_add(1, kRelaxed);
    microseconds.fetch_add(static_cast<uint64_t>(time.count()), kRelaxed);
}

std::string prometheusText(const Metrics& metrics, size_t datasets) {
    Text out;
    out.begin("build", "gauge", "The program that runs; always 1.");
    out.sample(
        "{version=\"" + std::string(buildInfo().version) + "\",commit=\"" + std::string(buildInfo().commit) + "\"}", 1);
    out.single("datasets", "gauge", "Datasets served.", static_cast<double>(datasets));
    out.begin("answers_total", "counter", "Answers by the class of their status.");
    for (size_t i = 2; i < metrics.answers.size(); ++i)
        out.sample("{status=\"" + std::to_string(i) + "xx\"}", number(metrics.answers[i]));
    out.single("sent_bytes_total", "counter", "Bytes sent, heads and bodies.", number(metrics.bytesSent));
    out.single("answers_cut_short_total", "counter", "Answers that their client did not take to the end.",
               number(metrics.cutShort));
    writeSeconds(out, metrics);
    out.single("connections", "gauge", "Connections open now.",
               static_cast<double>(metrics.connectionsOpen.load(kRelaxed)));
    out.single("connections_accepted_total", "counter", "Connections accepted.", number(metrics.connectionsAccepted));
    out.single("connections_refused_total", "counter", "Connections refused because there were too many.",
               number(metrics.connectionsRefused));
    out.single("connections_evicted_total", "counter", "Idle connections closed to make room for new ones.",
               number(metrics.connectionsEvicted));
    out.single("connections_expired_total", "counter",
               "Connections closed because they were idle or slow for too long.", number(metrics.connectionsExpired));
    writeTiles(out, metrics);
    out.single("reloads_total", "counter", "Reloads of the datasets.", number(metrics.reloads));
    out.single("log_lines_dropped_total", "counter", "Lines of the access log that its reader was too slow for.",
               number(metrics.logLinesDropped));
    return out.take();
}

}  // namespace terray::server

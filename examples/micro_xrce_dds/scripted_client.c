/* A Micro XRCE-DDS client that does what its arguments say, for experiments with a real Agent.
 *
 *   scripted_client PORT KEY ROLE [history=N] STEP...
 *
 * PORT is that of an Agent or a relay on 127.0.0.1, KEY the client key in hexadecimal, ROLE is publisher, subscriber or
 * both. The samples of topic "Numbers" are 1, 2, 3, ...; both reliable streams have N slots (8).
 *
 * Steps, done one after the other:
 *   write              give the next sample to the library; it is sent by the next step that runs the session
 *   insist MS          write; if the library refuses the sample, run the session for MS and try again, up to 500 times
 *   run MS             run the session for so long
 *   confirm MS         run the session until everything is confirmed, at most so long
 *   read N             ask for N samples (READ_DATA), 65535 for all that come
 *   sleep MS           the radio is off: nothing is sent, what arrives is gone
 *   pause MS           the program does something else; what arrives waits in the socket
 *   ping MS            ask within the session whether the Agent is there
 *   abandon            end without closing the session
 *   repeat N [ STEP... ]
 *
 * Each event is printed as a line of JSON with nanoseconds since the epoch.
 *
 * It is linked with libmicroxrcedds_client and libmicrocdr and reads the counters of the output stream, which the
 * library keeps in a structure that its headers show.
 */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <ucdr/microcdr.h>
#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>

#define MTU UXR_CONFIG_UDP_TRANSPORT_MTU
#define MOST_SLOTS 64
#define MOST_REPETITIONS 500

static uxrSession session;
static uxrUDPTransport transport;
static uxrStreamId output, input;
static uxrObjectId writer, reader;
static uint32_t written;
static uint8_t output_buffer[MTU * MOST_SLOTS], input_buffer[MTU * MOST_SLOTS];

static void tell(const char* event, const char* name, long value) {
    const uxrOutputReliableStream* out = &session.streams.output_reliable[0];
    struct timespec now;

    clock_gettime(CLOCK_REALTIME, &now);
    printf("{\"time\": %lld, \"event\": \"%s\"", (long long)now.tv_sec * 1000000000LL + now.tv_nsec, event);
    if (name) printf(", \"%s\": %ld", name, value);
    printf(", \"sent\": %u, \"acknowledged\": %u}\n", out->last_sent, out->last_acknown);
    fflush(stdout);
}

static void on_sample(uxrSession* of, uxrObjectId object, uint16_t request, uxrStreamId stream,
                      struct ucdrBuffer* buffer, uint16_t length, void* arguments) {
    uint32_t index = 0;

    (void)of, (void)object, (void)request, (void)stream, (void)length, (void)arguments;
    ucdr_deserialize_uint32_t(buffer, &index);
    tell("received", "index", index);
}

static bool write_sample(void) {
    ucdrBuffer buffer;

    if (uxr_prepare_output_stream(&session, output, writer, &buffer, 4) == UXR_INVALID_REQUEST_ID) return false;
    ucdr_serialize_uint32_t(&buffer, ++written);
    tell("written", "index", written);
    return true;
}

static void insist(int ms) {
    int refusals = 0;

    while (refusals <= MOST_REPETITIONS && !write_sample()) {
        uxr_run_session_timeout(&session, ms);
        refusals++;
    }
    if (refusals) tell("refused", "times", refusals);
}

static void wait_ms(long ms) {
    struct timespec time = {ms / 1000, ms % 1000 * 1000000};

    nanosleep(&time, NULL);
}

static void discard_what_arrived(void) {
    char octets[2048];
    long count = 0;

    while (recv(transport.platform.poll_fd.fd, octets, sizeof octets, MSG_DONTWAIT) >= 0) count++;
    tell("awake", "discarded", count);
}

static void read_samples(long number) {
    uxrDeliveryControl control = {.max_samples = (uint16_t)number};

    uxr_buffer_request_data(&session, output, reader, input, &control);
    tell("asked", "samples", number);
}

static int fail(const char* what) {
    fprintf(stderr, "scripted_client: %s\n", what);
    return 2;
}

/* Does one step that takes a number. */
static bool step(const char* name, long number) {
    if (!strcmp(name, "run")) {
        uxr_run_session_timeout(&session, (int)number);
    } else if (!strcmp(name, "confirm")) {
        tell("confirmed", "result", uxr_run_session_until_confirm_delivery(&session, (int)number));
    } else if (!strcmp(name, "insist")) {
        insist((int)number);
    } else if (!strcmp(name, "read")) {
        read_samples(number);
    } else if (!strcmp(name, "pause")) {
        wait_ms(number);
    } else if (!strcmp(name, "ping")) {
        tell("pinged", "answered", uxr_ping_agent_session(&session, (int)number, 1));
    } else if (!strcmp(name, "sleep")) {
        tell("asleep", "ms", number);
        wait_ms(number);
        discard_what_arrived();
    } else {
        return false;
    }
    return true;
}

static int steps(int count, char** arguments);

/* Does "N [ STEP... ]" N times and gives the number of arguments that it took, or -1. */
static int repeat(int count, char** arguments) {
    int depth = 1, end = 2;

    if (count < 3 || strcmp(arguments[1], "[")) return -1;
    for (; end < count && depth; end++) depth += !strcmp(arguments[end], "[") - !strcmp(arguments[end], "]");
    if (depth) return -1;
    for (long left = atol(arguments[0]); left > 0; left--)
        if (steps(end - 3, arguments + 2)) return -1;
    return end;
}

static int steps(int count, char** arguments) {
    for (int i = 0; i < count; i++) {
        if (!strcmp(arguments[i], "write")) {
            if (!write_sample()) tell("refused", "times", 1);
        } else if (!strcmp(arguments[i], "abandon")) {
            exit(0);
        } else if (!strcmp(arguments[i], "repeat")) {
            int taken = repeat(count - i - 1, arguments + i + 1);
            if (taken < 0) return fail("repeat N [ STEP... ]");
            i += taken;
        } else if (i + 1 < count && step(arguments[i], atol(arguments[i + 1]))) {
            i++;
        } else {
            return fail(arguments[i]);
        }
    }
    return 0;
}

static bool create_entities(bool publishes, bool subscribes) {
    uxrObjectId participant = uxr_object_id(1, UXR_PARTICIPANT_ID), topic = uxr_object_id(1, UXR_TOPIC_ID);
    uxrObjectId publisher = uxr_object_id(1, UXR_PUBLISHER_ID), subscriber = uxr_object_id(1, UXR_SUBSCRIBER_ID);
    uint16_t requests[6];
    uint8_t answers[6];
    size_t n = 0;

    writer = uxr_object_id(1, UXR_DATAWRITER_ID);
    reader = uxr_object_id(1, UXR_DATAREADER_ID);
    requests[n++] = uxr_buffer_create_participant_ref(&session, output, participant, 0, "participant", UXR_REPLACE);
    requests[n++] = uxr_buffer_create_topic_ref(&session, output, topic, participant, "Numbers__t", UXR_REPLACE);
    if (publishes) {
        requests[n++] = uxr_buffer_create_publisher_xml(&session, output, publisher, participant, "", UXR_REPLACE);
        requests[n++] = uxr_buffer_create_datawriter_ref(&session, output, writer, publisher, "Numbers__dw", UXR_REPLACE);
    }
    if (subscribes) {
        requests[n++] = uxr_buffer_create_subscriber_xml(&session, output, subscriber, participant, "", UXR_REPLACE);
        requests[n++] = uxr_buffer_create_datareader_ref(&session, output, reader, subscriber, "Numbers__dr", UXR_REPLACE);
    }
    return uxr_run_session_until_all_status(&session, 10000, requests, answers, n);
}

int main(int count, char** arguments) {
    int i = 4;
    uint16_t history = 8;

    if (count < 5) return fail("PORT KEY publisher|subscriber|both [history=N] STEP...");
    if (!strncmp(arguments[i], "history=", 8)) history = (uint16_t)atoi(arguments[i++] + 8);
    if (!history || history > MOST_SLOTS || history & (history - 1)) return fail("history must be 1, 2, 4, ... 64");
    if (!uxr_init_udp_transport(&transport, UXR_IPv4, "127.0.0.1", arguments[1])) return fail("no transport");
    uxr_init_session(&session, &transport.comm, (uint32_t)strtoul(arguments[2], NULL, 16));
    uxr_set_topic_callback(&session, on_sample, NULL);
    if (!uxr_create_session(&session)) return fail("no answer to CREATE_CLIENT");
    output = uxr_create_output_reliable_stream(&session, output_buffer, (size_t)MTU * history, history);
    input = uxr_create_input_reliable_stream(&session, input_buffer, (size_t)MTU * history, history);
    if (!create_entities(strcmp(arguments[3], "subscriber"), strcmp(arguments[3], "publisher")))
        return fail("the Agent refuses the entities");
    tell("ready", NULL, 0);
    if (steps(count - i, arguments + i)) return 2;
    tell("done", NULL, 0);
    uxr_delete_session_retries(&session, 1);
    uxr_close_udp_transport(&transport);
    return 0;
}

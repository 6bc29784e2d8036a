/* A valid pack is loaded; each kind of invalid pack has its own error, and never changes the running law. */
#include "check.h"

static md_law law;

static const md_motion MOTION = {.displacement = 0.1f, .velocity = 2.0f, .temperature = 20.0f};

static bool no_reading(void *context, md_reading *reading)
{
    (void)context, (void)reading;
    return false;
}

static bool no_drive(void *context, float command)
{
    (void)context, (void)command;
    return false;
}

static bool no_enable(void *context, bool on)
{
    (void)context, (void)on;
    return false;
}

/* A law whose initialisation was refused is not a law: no function accepts it. */
static void is_no_law(md_law *fresh)
{
    static md_emulation emulation;
    static md_rig rig;
    md_emulation_settings settings;
    md_rig_settings rig_settings;
    md_wiring wiring;
    md_problem problem;
    wire(&wiring, 0.5);
    CHECK(md_law_force(fresh, &MOTION) == 0.0f);
    CHECK(md_law_rest(fresh) == MD_ERROR_NOT_INITIALIZED && !md_law_boundary(fresh));
    CHECK(md_emulation_defaults(&settings) == MD_ERROR_NONE && md_rig_defaults(&rig_settings) == MD_ERROR_NONE);
    CHECK(md_emulation_init(&emulation, &settings, &wiring, fresh, &problem) == MD_ERROR_NOT_INITIALIZED);
    CHECK(md_emulation_start(&emulation, &problem) == MD_ERROR_NOT_INITIALIZED);
    const md_block block = {.amplitude = 0.1, .from = 5.0, .to = 5.0, .cycles = 2};
    const md_programme programme = {.tick_rate = LINEAR_TICK_RATE, .ramp_cycles = 1, .blocks = &block, .count = 1};
    const md_rig_io io = {.read = no_reading, .drive = no_drive, .enable = no_enable};
    CHECK(md_rig_init(&rig, &rig_settings, &programme, &wiring, &io, fresh, &problem) == MD_ERROR_NOT_INITIALIZED);
    /* All other arguments were valid. */
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_init(&rig, &rig_settings, &programme, &wiring, &io, &law, &problem) == MD_ERROR_NONE);
}

/* Loading `length` bytes of `pack` is refused with `error`, and the running law gives the same force as before. */
static void is_refused(const uint8_t *pack, size_t length, const md_expected *expected, md_error error, md_problem *problem)
{
    md_law fresh;
    CHECK(md_law_init(&fresh, pack, length, expected, NULL) == error);
    is_no_law(&fresh);
    /* Neither is a law that was valid before. */
    load_linear(&fresh);
    CHECK(md_law_force(&fresh, &MOTION) != 0.0f);
    CHECK(md_law_init(&fresh, pack, length, expected, NULL) == error);
    is_no_law(&fresh);
    const float before = md_law_force(&law, &MOTION);
    CHECK(before != 0.0f);
    CHECK(md_law_load(&law, pack, length, expected, problem) == error);
    CHECK(problem->error == error);
    CHECK(!md_law_boundary(&law));
    CHECK(md_law_force(&law, &MOTION) == before);
    printf("%s: %s\n", md_error_name(error), md_error_help(error));
}

static void check_refusals(void)
{
    const md_expected right = {.tick_rate = LINEAR_TICK_RATE};
    uint8_t pack[LINEAR_PACK_LENGTH];
    md_problem problem;

    is_refused(linear_pack, LINEAR_PACK_LENGTH - 1, &right, MD_ERROR_PACK_LENGTH, &problem);
    CHECK(problem.value == LINEAR_PACK_LENGTH - 1 && problem.low == LINEAR_PACK_LENGTH && problem.high == LINEAR_PACK_LENGTH);

    const md_expected other_rate = {.tick_rate = 2.0f * LINEAR_TICK_RATE};
    is_refused(linear_pack, LINEAR_PACK_LENGTH, &other_rate, MD_ERROR_PACK_TICK_RATE, &problem);
    CHECK(problem.value == LINEAR_TICK_RATE && problem.low == 2.0f * LINEAR_TICK_RATE);
    CHECK(problem.field_length == strlen("tick_rate") && memcmp(problem.field, "tick_rate", problem.field_length) == 0);

    const md_expected other_model = {.identity = mount_identity};
    is_refused(linear_pack, LINEAR_PACK_LENGTH, &other_model, MD_ERROR_PACK_IDENTITY, &problem);

    const uint32_t in_force = LINEAR_REVISION;
    const md_expected newer = {.newer_than = &in_force};
    is_refused(linear_pack, LINEAR_PACK_LENGTH, &newer, MD_ERROR_PACK_REVISION, &problem);
    CHECK(problem.value == LINEAR_REVISION && problem.low == LINEAR_REVISION + 1.0);

    /* The version follows the four bytes "MDCP". */
    memcpy(pack, linear_pack, sizeof pack);
    pack[4]++;
    is_refused(pack, sizeof pack, &right, MD_ERROR_PACK_VERSION, &problem);
    CHECK(problem.value == linear_pack[4] + 1.0 && problem.high == linear_pack[4]);

    memcpy(pack, linear_pack, sizeof pack);
    pack[0] = 'X';
    is_refused(pack, sizeof pack, &right, MD_ERROR_PACK_MAGIC, &problem);

    for (size_t byte = 8; byte < sizeof pack; byte += 7) {
        md_law other;
        memcpy(pack, linear_pack, sizeof pack);
        pack[byte] ^= 4;
        CHECK(md_law_init(&other, pack, sizeof pack, &right, NULL) == MD_ERROR_PACK_CHECKSUM);
    }
    is_refused(pack, sizeof pack, &right, MD_ERROR_PACK_CHECKSUM, &problem);
}

/* A pack of version 6 is read, and contains no description. */
static void check_silent(void)
{
    md_pack_info info;
    md_problem problem;
    CHECK(md_pack_describe(silent_pack, SILENT_PACK_LENGTH, &info, &problem) == MD_ERROR_PACK_SILENT);
    CHECK(problem.error == MD_ERROR_PACK_SILENT);
    const md_expected at_a_rate = {.tick_rate = LINEAR_TICK_RATE};
    is_refused(silent_pack, SILENT_PACK_LENGTH, &at_a_rate, MD_ERROR_PACK_TICK_RATE, &problem);
    CHECK(problem.value != problem.value && problem.low == LINEAR_TICK_RATE);
    static md_law silent;
    const md_expected any = {.tick_rate = 0.0f};
    CHECK(md_law_init(&silent, silent_pack, SILENT_PACK_LENGTH, &any, &problem) == MD_ERROR_NONE);
    CHECK(md_law_force(&silent, &MOTION) != 0.0f);
}

/* A law with a dashpot below 0 can supply more energy than it absorbs. */
static void check_active(void)
{
    md_problem problem;
    const md_expected passive = {.tick_rate = ACTIVE_TICK_RATE};
    is_refused(active_pack, ACTIVE_PACK_LENGTH, &passive, MD_ERROR_PACK_ACTIVE, &problem);
    CHECK(problem.value == -0.5);
    CHECK(problem.field_length == 2 && memcmp(problem.field, "c1", 2) == 0);
    static md_law active;
    const md_expected any = {.tick_rate = ACTIVE_TICK_RATE, .allow_active = true};
    CHECK(md_law_init(&active, active_pack, ACTIVE_PACK_LENGTH, &any, &problem) == MD_ERROR_NONE);
    CHECK(md_law_force(&active, &MOTION) != 0.0f);
}

static void check_memory(void)
{
    static md_law never;
    const md_expected any = {.tick_rate = 0.0f};
    md_problem problem;
    /* A law that was never initialised gives no force, and reports this if the function can. */
    CHECK(md_law_force(&never, &MOTION) == 0.0f);
    CHECK(md_law_rest(&never) == MD_ERROR_NOT_INITIALIZED);
    CHECK(md_law_load(&never, linear_pack, LINEAR_PACK_LENGTH, &any, &problem) == MD_ERROR_NOT_INITIALIZED);
    CHECK(!md_law_boundary(&never));

    CHECK(md_law_force(NULL, &MOTION) == 0.0f && md_law_force(&law, NULL) == 0.0f);
    CHECK(md_law_init(NULL, linear_pack, LINEAR_PACK_LENGTH, &any, NULL) == MD_ERROR_NULL);
    CHECK(md_law_init(&never, NULL, LINEAR_PACK_LENGTH, &any, NULL) == MD_ERROR_NULL);
    CHECK(md_law_init(&never, linear_pack, LINEAR_PACK_LENGTH, NULL, &problem) == MD_ERROR_NULL);
    CHECK(problem.field == NULL && problem.field_length == 0);

    static uint64_t words[MD_LAW_SIZE / 8 + 2];
    void *odd = (uint8_t *)words + 1;
    CHECK(md_law_init(odd, linear_pack, LINEAR_PACK_LENGTH, &any, NULL) == MD_ERROR_MISALIGNED);
    CHECK(md_law_force(odd, &MOTION) == 0.0f);
}

static void check_info(void)
{
    md_pack_info info;
    CHECK(md_pack_describe(mount_pack, MOUNT_PACK_LENGTH, &info, NULL) == MD_ERROR_NONE);
    CHECK(info.tick_rate == MOUNT_TICK_RATE && info.revision == MOUNT_REVISION);
    CHECK(memcmp(info.identity, mount_identity, MD_IDENTITY) == 0);
    CHECK(strcmp(info.name, MOUNT_NAME) == 0);
    CHECK(info.has_range && info.displacement[0] == mount_displacement[0] && info.velocity[1] == mount_velocity[1]);
    CHECK(!info.has_amplitude && info.has_density && info.density == mount_density);
    CHECK(md_pack_describe(mount_pack, MOUNT_PACK_LENGTH - 1, &info, NULL) == MD_ERROR_PACK_LENGTH);
    CHECK(md_pack_describe(NULL, 0, &info, NULL) == MD_ERROR_NULL);
}

static void check_names(void)
{
    CHECK(strcmp(md_error_name(MD_ERROR_NONE), "MD_ERROR_NONE") == 0);
    CHECK(strcmp(md_error_name(MD_ERROR_OTHER), "MD_ERROR_OTHER") == 0);
    CHECK(strcmp(md_error_name(-1), "?") == 0 && strcmp(md_error_name(1000), "?") == 0);
    CHECK(strcmp(md_trip_name(MD_TRIP_DEMAND_LIMIT), "MD_TRIP_DEMAND_LIMIT") == 0);
    CHECK(strcmp(md_trip_name(-1), "?") == 0);
    /* Every error number has a name and a help text. */
    int names = 0;
    for (int code = 0; code < 100; code++) {
        if (strcmp(md_error_name(code), "?") != 0) {
            CHECK(strncmp(md_error_name(code), "MD_ERROR_", 9) == 0 && strlen(md_error_help(code)) > 10);
            names++;
        }
    }
    CHECK(names == 25);
}

void check_packs(void)
{
    const md_expected expected = {.tick_rate = MOUNT_TICK_RATE, .identity = mount_identity};
    md_problem problem;
    CHECK(md_law_init(&law, mount_pack, MOUNT_PACK_LENGTH, &expected, &problem) == MD_ERROR_NONE);
    CHECK(problem.error == MD_ERROR_NONE);
    print_bits("force", md_law_force(&law, &MOTION));
    /* Its slider is stretched now: the force on the way back is different, and after a rest it is the first one again. */
    const md_motion back = {.displacement = 0.05f, .velocity = -2.0f, .temperature = 20.0f};
    const float followed = md_law_force(&law, &back);
    CHECK(md_law_rest(&law) == MD_ERROR_NONE);
    const float rested = md_law_force(&law, &back);
    CHECK(followed != rested);
    print_bits("followed", followed);
    print_bits("rested", rested);
    check_refusals();
    check_silent();
    check_active();
    check_memory();
    check_info();
    check_names();

    /* Another law waits for the end of a cycle. */
    const float in_force = md_law_force(&law, &MOTION);
    const md_expected any = {.tick_rate = LINEAR_TICK_RATE};
    CHECK(md_law_load(&law, linear_pack, LINEAR_PACK_LENGTH, &any, &problem) == MD_ERROR_NONE);
    CHECK(md_law_force(&law, &MOTION) == in_force);
    CHECK(md_law_boundary(&law) && !md_law_boundary(&law));
    CHECK(is_near(md_law_force(&law, &MOTION), K1 * 0.1 + C * 2.0, 1e-6));
    printf("packs hold\n");
}

#!/usr/bin/env python3
"""The tester is tested: 'mcanopen conform' looks at devices that 'mcanopen sim --defect' makes
defective. Each defect has exactly the findings of the table.
"""
import concurrent.futures
import json
import os
import threading

import plant

DEVICE = plant.DATA / "conform.eds"
NODE = "5"
AT_ONCE = 20  # they wait most of the time
# No answer and no boot-up message is waited for longer than this where one is missing.
IMPATIENT = {"boot-up-missing": ["--boot-timeout", "200"], "nmt-reset": ["--boot-timeout", "500"]}

# One defect of each family has to pass the checks of all others, too.
ALL = None

# Where programs are slow: it is the tester and the gate that are looked at.
FEW = {"sdo-toggle-unchecked", "pdo-receive-preoperational", "emcy-register", "guard-both"}

# {defect: (families that are run, findings)}. More than one finding has a reason: checks that
# build on the same service, or, where it is told, what the defect cannot help doing.
DEFECTS = {
    "od-identity": (ALL, "eds-identity od-defaults"),
    # 1001h is missing for all who read it
    "od-mandatory": ("eds,od,emcy", "eds-mandatory od-read od-structure emcy-register-clear "
                                    "emcy-register emcy-gone"),
    "od-type": ("eds,sdo,od", "sdo-read-expedited sdo-block-upload od-defaults"),

    "sdo-upload-toggle": ("sdo", "sdo-segmented-read sdo-long-read"),
    "sdo-download-toggle": (ALL, "sdo-string-write od-write-defaults"),
    "sdo-toggle-unchecked": ("sdo", "sdo-toggle-upload sdo-toggle-upload-next "
                                    "sdo-toggle-download"),
    "sdo-abort-code": ("sdo,od,pdo", "sdo-missing-object od-absent pdo-map-missing"),
    "sdo-abort-sub": ("sdo,od,pdo", "sdo-missing-sub od-structure od-sub-count pdo-sub4"),
    "sdo-abort-object": ("sdo", "sdo-abort-object"),
    "sdo-short-answered": ("sdo", "sdo-short-frames"),
    "sdo-unknown-silent": ("sdo", "sdo-unknown-command"),
    "sdo-abort-answered": ("sdo", "sdo-abort-silent sdo-abort-upload sdo-abort-download "
                                  "sdo-block-upload-abort sdo-block-download-abort"),
    "sdo-abort-ignored": ("sdo", "sdo-abort-upload sdo-block-download-abort"),
    "sdo-size": ("sdo,od", "sdo-segmented-read"),
    "sdo-length-unchecked": ("sdo,od", "sdo-too-long sdo-too-short"),
    "sdo-limits-unchecked": ("sdo,od,emcy", "sdo-above-limit od-limits emcy-history-clear"),
    "sdo-parameter": ("sdo,od", "sdo-default-channel sdo-default-fixed od-defaults"),
    "sdo-stopped": ("sdo,nmt", "sdo-stopped"),

    "block-crc": ("sdo", "sdo-block-upload sdo-block-upload-long sdo-block-upload-crc "
                         "sdo-block-upload-sizes sdo-block-repeat-all sdo-block-repeat-some"),
    "block-crc-unchecked": ("sdo", "sdo-block-crc-wrong"),
    "block-resend": ("sdo", "sdo-block-repeat-all sdo-block-repeat-some"),
    "block-size": ("sdo", "sdo-block-upload-sizes sdo-block-repeat-all sdo-block-repeat-some"),
    "block-size-unchecked": ("sdo", "sdo-block-size-wrong"),
    "block-gap": ("sdo", "sdo-block-gap"),
    "block-length-unchecked": ("sdo", "sdo-block-length-wrong"),

    "od-read-only": ("sdo,od", "sdo-write-read-only sdo-default-fixed od-read-only"),
    "od-write-only": ("sdo,od", "sdo-read-write-only"),
    "od-undeclared": ("sdo,od", "od-absent"),
    "od-length": (ALL, "od-read"),
    "od-sub0": ("eds,od", "od-defaults od-sub-count"),
    "od-default": ("od,pdo", "od-defaults"),
    "od-limits": ("sdo,od", "sdo-below-limit od-limits"),

    "pdo-default-id": ("od,pdo", "od-defaults pdo-cob-ids pdo-remote"),
    "pdo-length": ("pdo", "pdo-length pdo-data"),
    "pdo-data": ("pdo", "pdo-data pdo-inhibit"),
    "pdo-remote": ("pdo", "pdo-remote"),
    "pdo-sync-half": ("pdo,sync", "pdo-each-sync pdo-fifth-sync pdo-acyclic"),
    "pdo-preoperational": (ALL, "pdo-preoperational"),
    # such a device has not left Operational, so that its counter of SYNC goes on
    "pdo-stopped": ("sdo,pdo,sync,nmt", "pdo-stopped sync-counter-restart"),
    "pdo-receive-preoperational": ("pdo,nmt", "pdo-receive-preoperational"),
    "pdo-short-taken": ("pdo,emcy-sent", "pdo-receive-short emcy-sent"),
    "pdo-mapping-unchecked": ("pdo", "pdo-map-locked pdo-map-missing pdo-map-length "
                                     "pdo-map-too-long pdo-map-forbidden pdo-map-receive-ro "
                                     "pdo-map-transmit-wo pdo-map-dummy"),
    "pdo-type-unchecked": ("pdo", "pdo-receive-types pdo-transmit-types pdo-remote-types"),
    "pdo-cob-id-unchecked": ("pdo,cob", "pdo-receive-locked pdo-transmit-locked cob-receive "
                                        "cob-transmit"),
    "pdo-inhibit": ("pdo", "pdo-inhibit"),
    "pdo-event-timer": ("pdo", "pdo-event-timer pdo-kept"),
    "pdo-deadline": ("pdo", "pdo-receive-deadline"),
    # no type has an effect, and none is refused
    "pdo-receive-type": ("pdo", "pdo-receive-types pdo-receive-sync"),

    # checks that need emergencies of their own are skipped where emcy-sent fails
    "emcy-missing": ("emcy,sync-length,heartbeat-watched-lost,guard-life",
                     "emcy-sent sync-length heartbeat-watched-lost guard-life"),
    "emcy-code": ("emcy,sync-length,heartbeat-watched-lost,guard-life",
                  "emcy-sent sync-length heartbeat-watched-lost guard-life"),
    "emcy-register": ("emcy,pdo-receive-deadline",
                      "emcy-sent emcy-register pdo-receive-deadline"),
    "emcy-length": (ALL, "emcy-sent"),
    "emcy-reset-missing": ("emcy,control", "emcy-gone heartbeat-watched-back guard-life"),
    "emcy-id": ("od,emcy-cob-id,emcy-sent", "od-defaults emcy-cob-id emcy-sent"),
    # what is confirmed and has no effect is not refused either
    "emcy-never-off": ("emcy,cob", "emcy-off cob-emcy"),
    "emcy-inhibit": ("emcy", "emcy-inhibit"),
    "emcy-stopped": ("control,emcy", "heartbeat-watched-stopped"),
    "error-behaviour": ("control", "heartbeat-behaviour guard-behaviour"),
    "error-register": ("emcy", "emcy-register-clear emcy-register emcy-gone"),
    "error-field": ("emcy,od", "emcy-history-clear od-limits"),
    "error-field-code": ("emcy", "emcy-history emcy-history-kept emcy-history-order"),

    "sync-id": ("od,sync", "od-defaults sync-cob-id"),
    "sync-period": (ALL, "sync-producer"),
    "sync-period-unchanged": ("sync", "sync-producer sync-off sync-plain sync-counter "
                                      "sync-counter-restart sync-overflow-locked sync-stopped"),
    "sync-counter": ("sync,store", "sync-counter sync-counter-restart store-sync"),
    "sync-counter-missing": ("sync", "sync-counter sync-counter-restart"),
    "sync-overflow-unchecked": ("sync", "sync-overflow-values sync-overflow-locked"),
    "sync-stopped": ("sync,pdo,sdo-stopped", "sync-stopped sync-counter-restart"),
    "sync-length-unchecked": ("sync,emcy", "sync-length"),

    "heartbeat-state": ("nmt,control",
                        "nmt-reset-node nmt-reset-communication nmt-preoperational nmt-all-nodes "
                        "nmt-other-node nmt-length nmt-unknown heartbeat-states "
                        "heartbeat-watched-lost heartbeat-behaviour guard-first guard-toggle "
                        "guard-life guard-behaviour"),
    "heartbeat-slow": (ALL, "heartbeat-period"),
    "heartbeat-unchanged": ("control,store-save",
                            "heartbeat-period heartbeat-off guard-heartbeat store-save"),
    "heartbeat-twice": ("control", "heartbeat-watched-twice"),
    "heartbeat-deaf": ("control", "heartbeat-watched-lost heartbeat-watched-back "
                                  "heartbeat-behaviour"),
    "guard-toggle": ("control", "guard-toggle guard-states"),
    "guard-others": ("control", "guard-others"),
    "guard-both": ("control", "guard-heartbeat"),
    "guard-life": ("control", "guard-restored guard-life guard-behaviour"),

    "cob-id-restricted": ("cob", "cob-sync cob-time cob-emcy"),
    "store-signature": ("store", "store-signature store-load-signature"),
    # without "save" a wrong "load" cannot be told from a right one
    "store-nothing": ("store", "store-save store-save-communication store-sync store-date "
                               "store-load-signature"),
    "restore-nothing": ("store", "store-load"),
    "store-date": (ALL, "store-date"),

    "boot-up-twice": ("nmt,control", "nmt-reset-node nmt-reset-communication"),
    # a check that resets the device itself waits for the message
    "boot-up-missing": ("nmt", "nmt-reset-node nmt-reset-communication nmt-restore-node "
                               "nmt-restore-communication nmt-application-kept"),
    "boot-up-unasked": (ALL, "nmt-no-boot-up"),
    "nmt-others": ("nmt,control", "nmt-other-node"),
    "nmt-broadcast": ("nmt", "nmt-all-nodes"),
    "nmt-length": ("nmt", "nmt-length"),
    "nmt-unknown": ("nmt", "nmt-unknown"),
    "nmt-start": ("nmt,heartbeat-states,guard-states,emcy-sent",
                  "nmt-start nmt-burst heartbeat-states guard-states emcy-sent"),
    "nmt-stop": ("nmt,sdo-stopped,pdo-stopped,sync-stopped,heartbeat-states",
                 "nmt-stop nmt-all-nodes sdo-stopped pdo-stopped sync-stopped heartbeat-states"),
    "nmt-reset": ("nmt", "nmt-reset-communication nmt-restore-communication "
                         "nmt-application-kept"),
}


class ConformDefects(plant.PlantTest):
    lock = threading.Lock()

    def start_defective(self, name, bus):
        options = ["--defect", name] if name else []
        command = [*plant.WRAP, plant.MCANOPEN, "sim", "-q", "--bus", bus, "--node", NODE, DEVICE,
                   *options]
        with self.lock:
            sim = self.start(command)
        sim.wait_for("simulated device")
        return sim

    def findings(self, number, name, only):
        """The names of the checks that fail."""
        bus = f"virtual:conform-{os.getpid()}-{number}"
        sim = self.start_defective(name, bus)
        options = IMPATIENT.get(name, []) + (["--only", only] if only else [])
        with self.lock:
            tester = self.start([plant.MCANOPEN, "conform", "--json", "--bus", bus, "--node", NODE,
                                 "--eds", DEVICE, "--allow-store", *options])
        code = tester.wait()
        sim.stop()
        self.assertIn(code, (0, 1), f"{name}: {tester.err.text()}")
        report = json.loads(tester.out.text())
        return {check["name"]: check["reason"] for check in report["checks"]
                if check["verdict"] == "FAIL"}

    def judge(self, name, found):
        expected = set(DEFECTS[name][1].split())
        return [f"{name}: expected {check} to fail" for check in sorted(expected - set(found))] + \
            [f"{name}: {check}: {found[check]}" for check in sorted(set(found) - expected)]

    def test_defects(self):
        """exactly the right checks fail, at each defect"""
        listed = self.run_command([plant.MCANOPEN, "sim", "--defect", "help"]).out.text()
        names = [line.split()[1] for line in listed.splitlines()]
        self.assertEqual(set(names), set(DEFECTS))
        if plant.BRIEF or plant.SANITIZED:
            names = [name for name in names if name in FEW]
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            # those that take longest first
            names.sort(key=lambda name: DEFECTS[name][0] is not ALL)
            runs = {name: pool.submit(self.findings, number, name, DEFECTS[name][0])
                    for number, name in enumerate(names)}
        wrong = [line for name, run in runs.items() for line in self.judge(name, run.result())]
        plant.say(f"{len(names)} defects")
        self.assertEqual(wrong, [], "\n".join(wrong))


if __name__ == "__main__":
    plant.main()

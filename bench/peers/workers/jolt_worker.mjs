// Jolt's npm package (WebAssembly, single precision, one thread) as a worker of bench_peers: the questions of protocol.py.
// --steps V P: iterations of the solver for velocities and positions; --slop M: overlap that is left, m.
import { createInterface } from "node:readline";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import path from "node:path";

const folder = process.argv[2];
const require = createRequire(path.join(folder, "package.json"));
const Jolt = await (await import(pathToFileURL(require.resolve("jolt-physics")))).default();
const option = (name, count) => {
  const at = process.argv.indexOf(name);
  return at < 0 ? null : process.argv.slice(at + 1, at + 1 + count).map(Number);
};

const FIXED = 0, FREE = 1, PLANE = -1;

class Engine {
  build(scene) {
    if (this.jolt) Jolt.destroy(this.jolt);
    this.scene = scene;
    const settings = new Jolt.JoltSettings();
    const pairs = new Jolt.ObjectLayerPairFilterTable(2);
    pairs.EnableCollision(FIXED, FREE);
    pairs.EnableCollision(FREE, FREE);
    const layers = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
    layers.MapObjectToBroadPhaseLayer(FIXED, new Jolt.BroadPhaseLayer(0));
    layers.MapObjectToBroadPhaseLayer(FREE, new Jolt.BroadPhaseLayer(1));
    settings.mObjectLayerPairFilter = pairs;
    settings.mBroadPhaseLayerInterface = layers;
    settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
    settings.mMaxWorkerThreads = 0;
    this.jolt = new Jolt.JoltInterface(settings);
    Jolt.destroy(settings);
    this.system = this.jolt.GetPhysicsSystem();
    this.interface = this.system.GetBodyInterface();
    this.system.SetGravity(new Jolt.Vec3(...scene.gravity));
    const physics = this.system.GetPhysicsSettings();
    physics.mAllowSleeping = false;
    const steps = option("--steps", 2), slop = option("--slop", 1);
    if (steps) [physics.mNumVelocitySteps, physics.mNumPositionSteps] = steps;
    if (slop) [physics.mPenetrationSlop] = slop;
    const soft = scene.box_container;
    if (soft.stiffness > 0) {  // N/m: overlap that is left, as deep as the first body's weight sinks
      physics.mPenetrationSlop = scene.bodies[0].mass * Math.hypot(...scene.gravity) / soft.stiffness;
      physics.mBaumgarte = soft.damping / 400;  // Ns/m: with 200, the most of tosses, a step takes half of the rest
    }
    this.system.SetPhysicsSettings(physics);
    this.bodies = new Map();
    scene.bodies.forEach((body, i) => this.add(i, body));
    if (scene.plane !== null) {
      const pose = [0, 0, scene.plane - 0.5, 1, 0, 0, 0];
      this.add(PLANE, { half: [5, 5, 0.5], mass: 0, pose, is_round: false });
    }
    this.absent = new Set(scene.bodies.flatMap((body, i) => (body.present ? [] : [i])));
    this.cpu = 0;
  }

  shape_of({ half, is_round, moments, middle }) {
    const rounding = Math.min(0.0005, Math.min(...half) / 2);
    if (is_round) {  // its axis is y
      const turn = Jolt.Quat.prototype.sRotation(new Jolt.Vec3(1, 0, 0), Math.PI / 2);
      const round = new Jolt.CylinderShapeSettings(half[2], half[0], rounding);
      return new Jolt.RotatedTranslatedShapeSettings(new Jolt.Vec3(0, 0, 0), turn, round).Create().Get();
    }
    if (!moments) return new Jolt.BoxShape(new Jolt.Vec3(...half), rounding);
    const box = new Jolt.BoxShapeSettings(new Jolt.Vec3(...half), rounding);
    const unturned = Jolt.Quat.prototype.sIdentity();
    const aside = new Jolt.RotatedTranslatedShapeSettings(new Jolt.Vec3(...middle), unturned, box);
    // The body's frame is at its centre of mass.
    return new Jolt.OffsetCenterOfMassShapeSettings(new Jolt.Vec3(...middle.map((x) => -x)), aside).Create().Get();
  }

  add(i, body) {
    const is_box = body.mass > 0;
    const shape = this.shape_of(body);
    const settings = new Jolt.BodyCreationSettings(
      shape, position(body.pose), rotation(body.pose),
      is_box ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static, is_box ? FREE : FIXED);
    // Jolt takes the root of the product of two frictions, and the larger restitution.
    const { box_box, box_container } = this.scene;
    settings.mFriction = is_box ? box_box.friction : box_container.friction ** 2 / box_box.friction;
    settings.mRestitution = is_box ? box_box.restitution : box_container.restitution;
    settings.mLinearDamping = 0;
    settings.mAngularDamping = 0;
    settings.mAllowSleeping = false;
    if (is_box) {
      settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_CalculateInertia;
      settings.mMassPropertiesOverride.mMass = body.mass;
      if (body.moments) {
        settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
        const moments = new Jolt.Vec3(...body.moments);
        settings.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(moments);
        Jolt.destroy(moments);
      }
    }
    const made = this.interface.CreateBody(settings);
    this.interface.AddBody(made.GetID(), is_box ? Jolt.EActivation_Activate : Jolt.EActivation_DontActivate);
    Jolt.destroy(settings);
    this.bodies.set(i, made);
  }

  step() {
    for (const body of this.absent) this.set_motion(body, this.parked(body), [0, 0, 0, 0, 0, 0]);
    const begin = process.cpuUsage();
    this.jolt.Step(this.scene.dt, 1);
    const spent = process.cpuUsage(begin);
    this.cpu += 1e-6 * (spent.user + spent.system);
  }

  parked(body) {
    return [10 + body, 0, 100, 1, 0, 0, 0];
  }

  set_motion(body, pose, velocity) {
    const id = this.bodies.get(body).GetID();
    const place = position(pose), turn = rotation(pose);
    this.interface.SetPositionAndRotation(id, place, turn, Jolt.EActivation_Activate);
    const linear = new Jolt.Vec3(...velocity.slice(0, 3)), angular = new Jolt.Vec3(...velocity.slice(3));
    this.interface.SetLinearAndAngularVelocity(id, linear, angular);
    [place, turn, linear, angular].forEach((thing) => Jolt.destroy(thing));
  }

  push(body, force, torque) {
    const f = new Jolt.Vec3(...force), t = new Jolt.Vec3(...torque);
    this.interface.AddForceAndTorque(this.bodies.get(body).GetID(), f, t, Jolt.EActivation_Activate);
    [f, t].forEach((thing) => Jolt.destroy(thing));
  }

  pose(body) {
    const rigid = this.bodies.get(body);
    const p = rigid.GetCenterOfMassPosition(), q = rigid.GetRotation();
    return [p.GetX(), p.GetY(), p.GetZ(), q.GetW(), q.GetX(), q.GetY(), q.GetZ()];
  }

  state() {
    const poses = [], velocities = [];
    let failed = false;
    this.scene.bodies.forEach((body, i) => {
      if (body.mass === 0) {
        poses.push(body.pose);
        velocities.push([0, 0, 0, 0, 0, 0]);
        return;
      }
      const rigid = this.bodies.get(i), pose = this.pose(i);
      const v = rigid.GetLinearVelocity(), w = rigid.GetAngularVelocity();
      failed ||= !pose.every(Number.isFinite);
      poses.push(failed ? body.pose : pose);
      velocities.push([v.GetX(), v.GetY(), v.GetZ(), w.GetX(), w.GetY(), w.GetZ()].map((x) => (failed ? 0 : x)));
    });
    return { poses, velocities, cpu: this.cpu, failed };
  }

  act({ set, insert, push, steps = 0, follow, pose, velocity, force, torque }) {
    const moved = set ?? insert;
    if (moved !== undefined) {
      this.absent.delete(moved);
      this.set_motion(moved, pose, velocity);
    }
    if (push !== undefined) this.push(push, force, torque);
    for (let i = 0; i < steps; ++i) {
      this.step();
      if (follow === undefined) continue;
      const now = this.pose(follow);
      if (!now.every(Number.isFinite)) return;
      this.path.push(now);
    }
  }

  answer(question) {
    if (question.build) {
      this.build(question.build);
      for (const i of this.absent) question.build.bodies[i].pose = this.parked(i);
    }
    const acts = question.do ?? [];
    this.path = [];
    for (const act of acts) this.act(act);
    // The package does not tell contact forces.
    if (question.normal_force) return { normal_force: null };
    return acts.some((act) => act.follow !== undefined) ? { ...this.state(), path: this.path } : this.state();
  }
}

const position = (pose) => new Jolt.RVec3(...pose.slice(0, 3));
const rotation = ([, , , w, x, y, z]) => new Jolt.Quat(x, y, z, w);

const engine = new Engine();
for await (const line of createInterface({ input: process.stdin })) {
  let answer;
  try {
    answer = engine.answer(JSON.parse(line));
  } catch (error) {
    answer = { error: String(error?.stack ?? error) };
  }
  process.stdout.write(JSON.stringify(answer) + "\n");
}

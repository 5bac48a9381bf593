/// Camera, light and ground, and pictures of what stands on it.

import {
  CanvasTexture,
  Color,
  DirectionalLight,
  HemisphereLight,
  Mesh,
  NeutralToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  PMREMGenerator,
  Scene,
  ShaderMaterial,
  ShadowMaterial,
  SRGBColorSpace,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';
import { colors, kFieldOfView, type Theme } from './palette';

const kRatios = [1, 0.8, 0.65];  // Of the resolution, by economy.

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(kFieldOfView, 1, 0.04, 60);
  readonly renderer: WebGLRenderer;
  readonly orbit: OrbitControls;
  /** Whether a person has chosen the view since it was last framed. */
  handled = false;
  private level = 0;
  private moves = 0;
  private readonly sun = new DirectionalLight('#ffffff', 2.2);
  private readonly sky = new HemisphereLight('#ffffff', '#b9c2cc', 0.6);
  private readonly grid: Mesh<PlaneGeometry, ShaderMaterial>;
  private readonly shade: Mesh<PlaneGeometry, ShadowMaterial>;

  /** @param draft  draws edges and shadows coarsely: a tenth of the work where no graphics hardware does it */
  constructor(readonly canvas: HTMLCanvasElement, draft: boolean, changed: () => void) {
    this.renderer = makeRenderer(canvas, !draft);
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(3, -2, 2);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = true;
    this.orbit.dampingFactor = 0.12;
    this.orbit.minDistance = 0.1;
    this.orbit.maxDistance = 25;
    this.orbit.addEventListener('change', changed);
    this.orbit.addEventListener('start', () => (this.handled = true));

    const room = new RoomEnvironment();
    const prefilter = new PMREMGenerator(this.renderer);
    this.scene.environment = prefilter.fromScene(room, 0.04).texture;
    this.scene.environmentIntensity = 0.45;
    this.scene.environmentRotation.x = Math.PI / 2;  // The room stands on y.
    prefilter.dispose();
    room.dispose();

    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(draft ? 256 : 2048);
    this.sun.shadow.autoUpdate = false;  // Turning the camera moves no shadow.
    this.sun.shadow.radius = 3;
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.01;
    this.sky.position.set(0, 0, 1);
    this.grid = makeGrid();
    this.shade = new Mesh(new PlaneGeometry(40, 40), new ShadowMaterial({ opacity: 0.22 }));
    this.shade.receiveShadow = true;
    this.shade.renderOrder = -2;
    this.scene.add(this.sun, this.sun.target, this.sky, this.shade, this.grid);
  }

  setTheme(theme: Theme): void {
    this.scene.background = gradient(colors.background[theme]);
    this.grid.material.uniforms.color.value.set(colors.grid[theme]);
    this.scene.environmentIntensity = theme === 'light' ? 0.45 : 0.42;
    this.sun.intensity = theme === 'light' ? 2.2 : 1.7;
    this.sky.intensity = theme === 'light' ? 0.6 : 0.55;
  }

  /** @param height of the ground [m] */
  setGround(height: number): void {
    this.grid.position.z = height + 0.001;
    this.shade.position.z = height;
  }

  resize(width: number, height: number): void {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * kRatios[this.economy]);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
  }

  /** Looks at all points from `direction` (from them to the camera), as near as they fit. */
  frame(points: Vector3[], direction: Vector3): void {
    if (points.length === 0) return;
    const back = direction.clone().normalize();
    const right = this.camera.up.clone().cross(back).normalize();
    const up = back.clone().cross(right);
    const tan = Math.tan((this.camera.fov * Math.PI) / 360) * 0.88;
    const tans = [tan * this.camera.aspect, tan];
    const target = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length);
    let distance = 1;
    const rounds = 8;
    for (let round = 0; round < rounds; ++round) {
      // As seen from here: right, up and towards the camera.
      const seen = points.map((point) => {
        const p = point.clone().sub(target);
        return { xy: [p.dot(right), p.dot(up)], depth: p.dot(back) };
      });
      distance = Math.max(0.3, ...seen.flatMap(({ xy, depth }) => xy.map((x, i) => depth + Math.abs(x) / tans[i])));
      if (round === rounds - 1) break;
      [right, up].forEach((axis, i) => {
        const slopes = seen.map(({ xy, depth }) => xy[i] / Math.max(distance - depth, 0.1));
        target.addScaledVector(axis, ((Math.min(...slopes) + Math.max(...slopes)) / 2) * distance);
      });
    }
    this.handled = false;
    this.orbit.target.copy(target);
    this.camera.position.copy(target).addScaledVector(back, distance);
    this.orbit.update();
  }

  /** The light covers a ball around what moves. */
  light(center: Vector3, radius: number): void {
    this.sun.target.position.copy(center);
    this.sun.position.copy(center).add(new Vector3(0.35, -0.5, 1).normalize().multiplyScalar(4 * radius));
    const box = this.sun.shadow.camera;
    [box.left, box.right, box.bottom, box.top] = [-radius, radius, -radius, radius];
    [box.near, box.far] = [radius, 8 * radius];
    box.updateProjectionMatrix();
    this.moved();
  }

  render(): void {
    this.renderer.render(this.scene, this.camera);
  }

  /** 0 draws everything as well as possible; 1 and 2 are for machines that cannot keep up. */
  get economy(): number {
    return this.level;
  }

  setEconomy(level: number): void {
    if (level === this.level) return;
    this.level = level;
    const { x: width, y: height } = this.renderer.getSize(new Vector2());
    this.resize(width, height);
    this.sun.shadow.needsUpdate = true;
  }

  /** To be called when something has moved, appeared or gone. */
  moved(): void {
    this.moves = (this.moves + 1) % (this.level + 1);
    if (this.moves === 0) this.sun.shadow.needsUpdate = true;
  }

  /** Draws at another size, hands the canvas to `use`, and goes back. */
  async at<Value>(width: number, height: number, use: () => Promise<Value>): Promise<Value> {
    const ratio = this.renderer.getPixelRatio();
    const { x: w, y: h } = this.renderer.getSize(new Vector2());
    const aspect = this.camera.aspect;
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    try {
      return await use();
    } finally {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(w, h, false);
      this.camera.aspect = aspect;
      this.camera.updateProjectionMatrix();
    }
  }
}

function makeRenderer(canvas: HTMLCanvasElement, antialias: boolean): WebGLRenderer {
  try {
    return new WebGLRenderer({ canvas, antialias });
  } catch {
    throw new Error('This browser does not draw in three dimensions: WebGL 2 is switched off or missing.');
  }
}

function gradient([top, bottom]: string[]): CanvasTexture {
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [4, 256];
  const g = canvas.getContext('2d')!;
  const fill = g.createLinearGradient(0, 0, 0, 256);
  fill.addColorStop(0, top);
  fill.addColorStop(1, bottom);
  g.fillStyle = fill;
  g.fillRect(0, 0, 4, 256);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

/** Lines every 0.1 m, stronger every 1 m, that fade out with the distance from the origin. */
function makeGrid(): Mesh<PlaneGeometry, ShaderMaterial> {
  const material = new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: { color: { value: new Color() } },
    vertexShader: `
      varying vec2 p;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        p = world.xy;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: `
      uniform vec3 color;
      varying vec2 p;
      float lines(float step, float width) {
        vec2 x = p / step;
        vec2 w = fwidth(x);
        vec2 near = abs(fract(x - 0.5) - 0.5) / max(w, 1e-6);
        float line = 1.0 - min(min(near.x, near.y) / width, 1.0);
        return line * clamp(1.0 - 3.0 * max(w.x, w.y), 0.0, 1.0);
      }
      void main() {
        float fade = 1.0 - smoothstep(1.2, 4.5, length(p));
        float strength = max(0.16 * lines(0.1, 1.0), 0.4 * lines(1.0, 1.3));
        gl_FragColor = vec4(color, strength * fade);
        #include <colorspace_fragment>
      }`,
  });
  const mesh = new Mesh(new PlaneGeometry(12, 12), material);
  mesh.renderOrder = -1;
  return mesh;
}
